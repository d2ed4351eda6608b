"""Runge–Kutta methods, stages unrolled. Written by unroll.py: do not edit.

All of them: kernel, time t [s], step h [s], state x (d,), stages k (stages, d), scratch y (d,), the
kernel's workspace, and the number d as a constant. Explicit methods find f(t, x) in the first row of k.
"""

# ruff: noqa: E501 (one sum of a tableau's row is one line)
# fmt: off
from numba import njit

from flexsurr.simulation.dimension import ORDERED, states
from flexsurr.simulation.rhs import rhs


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def rk4_step_0(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    for i in range(d):
        y[i] = x[i] + (h * 0.5) * k0[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def rk4_step_1(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k1 = k[1]
    for i in range(d):
        y[i] = x[i] + (h * 0.5) * k1[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def rk4_step_2(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k2 = k[2]
    for i in range(d):
        y[i] = x[i] + (h * 1.0) * k2[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def rk4_step_3(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k1 = k[1]
    k2 = k[2]
    k3 = k[3]
    for i in range(d):
        y[i] = x[i] + (h * 0.16666666666666666) * k0[i] + (h * 0.3333333333333333) * k1[i] + (h * 0.3333333333333333) * k2[i] + (h * 0.16666666666666666) * k3[i]


@njit(error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def rk4_step(kernel, t, h, x, x_new, k, y, work, constant):
    """Write the state at t + h into x_new, which may be x."""
    rk4_step_0(h, x, k, y, constant)
    rhs(kernel, t + 0.5 * h, y, k[1], work)
    rk4_step_1(h, x, k, y, constant)
    rhs(kernel, t + 0.5 * h, y, k[2], work)
    rk4_step_2(h, x, k, y, constant)
    rhs(kernel, t + 1.0 * h, y, k[3], work)
    rk4_step_3(h, x, k, x_new, constant)


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_0(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    for i in range(d):
        y[i] = x[i] + (h * 0.05260015195876773) * k0[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_1(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k1 = k[1]
    for i in range(d):
        y[i] = x[i] + (h * 0.0197250569845379) * k0[i] + (h * 0.0591751709536137) * k1[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_2(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k2 = k[2]
    for i in range(d):
        y[i] = x[i] + (h * 0.02958758547680685) * k0[i] + (h * 0.08876275643042054) * k2[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_3(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k2 = k[2]
    k3 = k[3]
    for i in range(d):
        y[i] = x[i] + (h * 0.2413651341592667) * k0[i] - (h * 0.8845494793282861) * k2[i] + (h * 0.924834003261792) * k3[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_4(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k3 = k[3]
    k4 = k[4]
    for i in range(d):
        y[i] = x[i] + (h * 0.037037037037037035) * k0[i] + (h * 0.17082860872947386) * k3[i] + (h * 0.12546768756682242) * k4[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_5(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k3 = k[3]
    k4 = k[4]
    k5 = k[5]
    for i in range(d):
        y[i] = x[i] + (h * 0.037109375) * k0[i] + (h * 0.17025221101954405) * k3[i] + (h * 0.06021653898045596) * k4[i] - (h * 0.017578125) * k5[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_6(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k3 = k[3]
    k4 = k[4]
    k5 = k[5]
    k6 = k[6]
    for i in range(d):
        y[i] = x[i] + (h * 0.03709200011850479) * k0[i] + (h * 0.17038392571223998) * k3[i] + (h * 0.10726203044637328) * k4[i] - (h * 0.015319437748624402) * k5[i] + (h * 0.008273789163814023) * k6[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_7(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k3 = k[3]
    k4 = k[4]
    k5 = k[5]
    k6 = k[6]
    k7 = k[7]
    for i in range(d):
        y[i] = x[i] + (h * 0.6241109587160757) * k0[i] - (h * 3.3608926294469414) * k3[i] - (h * 0.868219346841726) * k4[i] + (h * 27.59209969944671) * k5[i] + (h * 20.154067550477894) * k6[i] - (h * 43.48988418106996) * k7[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_8(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k3 = k[3]
    k4 = k[4]
    k5 = k[5]
    k6 = k[6]
    k7 = k[7]
    k8 = k[8]
    for i in range(d):
        y[i] = x[i] + (h * 0.47766253643826434) * k0[i] - (h * 2.4881146199716677) * k3[i] - (h * 0.590290826836843) * k4[i] + (h * 21.230051448181193) * k5[i] + (h * 15.279233632882423) * k6[i] - (h * 33.28821096898486) * k7[i] - (h * 0.020331201708508627) * k8[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_9(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k3 = k[3]
    k4 = k[4]
    k5 = k[5]
    k6 = k[6]
    k7 = k[7]
    k8 = k[8]
    k9 = k[9]
    for i in range(d):
        y[i] = x[i] - (h * 0.9371424300859873) * k0[i] + (h * 5.186372428844064) * k3[i] + (h * 1.0914373489967295) * k4[i] - (h * 8.149787010746927) * k5[i] - (h * 18.52006565999696) * k6[i] + (h * 22.739487099350505) * k7[i] + (h * 2.4936055526796523) * k8[i] - (h * 3.0467644718982196) * k9[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_10(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k3 = k[3]
    k4 = k[4]
    k5 = k[5]
    k6 = k[6]
    k7 = k[7]
    k8 = k[8]
    k9 = k[9]
    k10 = k[10]
    for i in range(d):
        y[i] = x[i] + (h * 2.273310147516538) * k0[i] - (h * 10.53449546673725) * k3[i] - (h * 2.0008720582248625) * k4[i] - (h * 17.9589318631188) * k5[i] + (h * 27.94888452941996) * k6[i] - (h * 2.8589982771350235) * k7[i] - (h * 8.87285693353063) * k8[i] + (h * 12.360567175794303) * k9[i] + (h * 0.6433927460157636) * k10[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step_11(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k5 = k[5]
    k6 = k[6]
    k7 = k[7]
    k8 = k[8]
    k9 = k[9]
    k10 = k[10]
    k11 = k[11]
    for i in range(d):
        y[i] = x[i] + (h * 0.054293734116568765) * k0[i] + (h * 4.450312892752409) * k5[i] + (h * 1.8915178993145003) * k6[i] - (h * 5.801203960010585) * k7[i] + (h * 0.3111643669578199) * k8[i] - (h * 0.1521609496625161) * k9[i] + (h * 0.20136540080403034) * k10[i] + (h * 0.04471061572777259) * k11[i]


@njit(error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_step(kernel, t, h, x, x_new, k, y, work, constant):
    """Write the state at t + h into x_new, which may be x."""
    dop853_step_0(h, x, k, y, constant)
    rhs(kernel, t + 0.05260015195876773 * h, y, k[1], work)
    dop853_step_1(h, x, k, y, constant)
    rhs(kernel, t + 0.0789002279381516 * h, y, k[2], work)
    dop853_step_2(h, x, k, y, constant)
    rhs(kernel, t + 0.1183503419072274 * h, y, k[3], work)
    dop853_step_3(h, x, k, y, constant)
    rhs(kernel, t + 0.2816496580927726 * h, y, k[4], work)
    dop853_step_4(h, x, k, y, constant)
    rhs(kernel, t + 0.3333333333333333 * h, y, k[5], work)
    dop853_step_5(h, x, k, y, constant)
    rhs(kernel, t + 0.25 * h, y, k[6], work)
    dop853_step_6(h, x, k, y, constant)
    rhs(kernel, t + 0.3076923076923077 * h, y, k[7], work)
    dop853_step_7(h, x, k, y, constant)
    rhs(kernel, t + 0.6512820512820513 * h, y, k[8], work)
    dop853_step_8(h, x, k, y, constant)
    rhs(kernel, t + 0.6 * h, y, k[9], work)
    dop853_step_9(h, x, k, y, constant)
    rhs(kernel, t + 0.8571428571428571 * h, y, k[10], work)
    dop853_step_10(h, x, k, y, constant)
    rhs(kernel, t + 1.0 * h, y, k[11], work)
    dop853_step_11(h, x, k, x_new, constant)


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False)
def dop853_error(x, x_new, k, rtol, atol, constant):
    """Sums of squares of the two error estimates over h, scaled."""
    d = states(constant, x)
    k0 = k[0]
    k5 = k[5]
    k6 = k[6]
    k7 = k[7]
    k8 = k[8]
    k9 = k[9]
    k10 = k[10]
    k11 = k[11]
    square_3 = 0.0
    square_5 = 0.0
    for i in range(d):
        scale = 1.0 / (atol + rtol * max(abs(x[i]), abs(x_new[i])))
        error_3 = scale * ( - 0.18980075407240762 * k0[i] + 4.450312892752409 * k5[i] + 1.8915178993145003 * k6[i] - 5.801203960010585 * k7[i] - 0.4226823213237919 * k8[i] - 0.1521609496625161 * k9[i] + 0.20136540080403034 * k10[i] + 0.02265179219836082 * k11[i])
        error_5 = scale * ( + 0.01312004499419488 * k0[i] - 1.2251564463762044 * k5[i] - 0.4957589496572502 * k6[i] + 1.6643771824549864 * k7[i] - 0.35032884874997366 * k8[i] + 0.3341791187130175 * k9[i] + 0.08192320648511571 * k10[i] - 0.022355307863886294 * k11[i])
        square_3 += error_3 * error_3
        square_5 += error_5 * error_5
    return square_3, square_5


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_dense_0(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k6 = k[6]
    k7 = k[7]
    k8 = k[8]
    k9 = k[9]
    k10 = k[10]
    k11 = k[11]
    k12 = k[12]
    for i in range(d):
        y[i] = x[i] + (h * 0.056167502283047954) * k0[i] + (h * 0.25350021021662483) * k6[i] - (h * 0.2462390374708025) * k7[i] - (h * 0.12419142326381637) * k8[i] + (h * 0.15329179827876568) * k9[i] + (h * 0.00820105229563469) * k10[i] + (h * 0.007567897660545699) * k11[i] - (h * 0.008298) * k12[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_dense_1(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k5 = k[5]
    k6 = k[6]
    k7 = k[7]
    k10 = k[10]
    k11 = k[11]
    k12 = k[12]
    k13 = k[13]
    for i in range(d):
        y[i] = x[i] + (h * 0.03183464816350214) * k0[i] + (h * 0.028300909672366776) * k5[i] + (h * 0.053541988307438566) * k6[i] - (h * 0.05492374857139099) * k7[i] - (h * 0.00010834732869724932) * k10[i] + (h * 0.0003825710908356584) * k11[i] - (h * 0.00034046500868740456) * k12[i] + (h * 0.1413124436746325) * k13[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)
def dop853_dense_2(h, x, k, y, constant):
    """Write x and a sum of stages into y, which may be x."""
    d = states(constant, x)
    k0 = k[0]
    k5 = k[5]
    k6 = k[6]
    k7 = k[7]
    k8 = k[8]
    k12 = k[12]
    k13 = k[13]
    k14 = k[14]
    for i in range(d):
        y[i] = x[i] - (h * 0.42889630158379194) * k0[i] - (h * 4.697621415361164) * k5[i] + (h * 7.683421196062599) * k6[i] + (h * 4.06898981839711) * k7[i] + (h * 0.3567271874552811) * k8[i] - (h * 0.0013990241651590145) * k12[i] + (h * 2.9475147891527724) * k13[i] - (h * 9.15095847217987) * k14[i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False)
def dop853_dense_coefficients(h, x, x_new, dense, k, constant):
    """Write the dense output's coefficients (7, d) from all stages."""
    d = states(constant, x)
    k0 = k[0]
    k5 = k[5]
    k6 = k[6]
    k7 = k[7]
    k8 = k[8]
    k9 = k[9]
    k10 = k[10]
    k11 = k[11]
    k12 = k[12]
    k13 = k[13]
    k14 = k[14]
    k15 = k[15]
    for i in range(d):
        dense[0, i] = x_new[i] - x[i]
        dense[1, i] = h * k0[i] - dense[0, i]
        dense[2, i] = 2.0 * dense[0, i] - h * (k12[i] + k0[i])
        dense[3, i] = h * ( - 8.428938276109013 * k0[i] + 0.5667149535193777 * k5[i] - 3.0689499459498917 * k6[i] + 2.38466765651207 * k7[i] + 2.117034582445028 * k8[i] - 0.871391583777973 * k9[i] + 2.2404374302607883 * k10[i] + 0.6315787787694688 * k11[i] - 0.08899033645133331 * k12[i] + 18.148505520854727 * k13[i] - 9.194632392478356 * k14[i] - 4.436036387594894 * k15[i])
        dense[4, i] = h * ( + 10.427508642579134 * k0[i] + 242.28349177525817 * k5[i] + 165.20045171727028 * k6[i] - 374.5467547226902 * k7[i] - 22.113666853125306 * k8[i] + 7.733432668472264 * k9[i] - 30.674084731089398 * k10[i] - 9.332130526430229 * k11[i] + 15.697238121770845 * k12[i] - 31.139403219565178 * k13[i] - 9.35292435884448 * k14[i] + 35.81684148639408 * k15[i])
        dense[5, i] = h * ( + 19.985053242002433 * k0[i] - 387.0373087493518 * k5[i] - 189.17813819516758 * k6[i] + 527.8081592054236 * k7[i] - 11.57390253995963 * k8[i] + 6.8812326946963 * k9[i] - 1.0006050966910838 * k10[i] + 0.7777137798053443 * k11[i] - 2.778205752353508 * k12[i] - 60.19669523126412 * k13[i] + 84.32040550667716 * k14[i] + 11.99229113618279 * k15[i])
        dense[6, i] = h * ( - 25.69393346270375 * k0[i] - 154.18974869023643 * k5[i] - 231.5293791760455 * k6[i] + 357.6391179106141 * k7[i] + 93.40532418362432 * k8[i] - 37.45832313645163 * k9[i] + 104.0996495089623 * k10[i] + 29.8402934266605 * k11[i] - 43.53345659001114 * k12[i] + 96.32455395918828 * k13[i] - 39.17726167561544 * k14[i] - 149.72683625798564 * k15[i])


@njit(error_model="numpy", fastmath=ORDERED, _nrt=False)
def dop853_dense(kernel, t, h, x, x_new, dense, k, y, work, constant):
    """Write the dense output's coefficients (7, d); k[12] holds f at the end of the step."""
    dop853_dense_0(h, x, k, y, constant)
    rhs(kernel, t + 0.1 * h, y, k[13], work)
    dop853_dense_1(h, x, k, y, constant)
    rhs(kernel, t + 0.2 * h, y, k[14], work)
    dop853_dense_2(h, x, k, y, constant)
    rhs(kernel, t + 0.7777777777777778 * h, y, k[15], work)
    dop853_dense_coefficients(h, x, x_new, dense, k, constant)


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False)
def gauss_legendre_4_extrapolate(x, k, constant):
    """Replace the last step's stages by a guess of the next's."""
    d = states(constant, x)
    k0 = k[0]
    k1 = k[1]
    for i in range(d):
        new0 = - 0.7320508075688774 * k0[i] + 1.7320508075688774 * k1[i]
        new1 = - 1.7320508075688774 * k0[i] + 2.732050807568877 * k1[i]
        k0[i] = new0
        k1[i] = new1


@njit(error_model="numpy", fastmath=ORDERED, _nrt=False)
def gauss_legendre_4_sweep(kernel, t, h, x, k, y, new, work, constant):
    """Evaluate each stage from the newest others; the largest change relative to the state, or NaN."""
    d = states(constant, x)
    k0 = k[0]
    k1 = k[1]
    largest = 0.0
    poison = 0.0
    for i in range(d):
        y[i] = x[i] + (h * 0.25) * k0[i] - (h * 0.038675134594812866) * k1[i]
    rhs(kernel, t + 0.21132486540518713 * h, y, new, work)
    for i in range(d):
        change = h * abs(new[i] - k0[i])
        scale = abs(x[i]) + h * abs(new[i])
        if change > largest * scale:
            largest = change / scale
        poison += 0.0 * change
        k0[i] = new[i]
    for i in range(d):
        y[i] = x[i] + (h * 0.5386751345948129) * k0[i] + (h * 0.25) * k1[i]
    rhs(kernel, t + 0.7886751345948129 * h, y, new, work)
    for i in range(d):
        change = h * abs(new[i] - k1[i])
        scale = abs(x[i]) + h * abs(new[i])
        if change > largest * scale:
            largest = change / scale
        poison += 0.0 * change
        k1[i] = new[i]
    return largest + poison


@njit(error_model="numpy", _nrt=False)
def gauss_legendre_4_increment(h, x, k, lost, constant):
    """Add the step to x and keep what rounding loses for the next (Kahan's summation)."""
    d = states(constant, x)
    k0 = k[0]
    k1 = k[1]
    for i in range(d):
        total = lost[i] + (h * 0.5) * k0[i] + (h * 0.5) * k1[i]
        before = x[i]
        x[i] = before + total
        lost[i] = (before - x[i]) + total


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False)
def gauss_legendre_6_extrapolate(x, k, constant):
    """Replace the last step's stages by a guess of the next's."""
    d = states(constant, x)
    k0 = k[0]
    k1 = k[1]
    k2 = k[2]
    for i in range(d):
        new0 = + 0.4603499871259163 * k0[i] - 1.5026888717234437 * k1[i] + 2.042338884597527 * k2[i]
        new1 = + 2.042338884597527 * k0[i] - 5.666666666666666 * k1[i] + 4.624327782069138 * k2[i]
        new2 = + 4.624327782069138 * k0[i] - 11.830644461609888 * k1[i] + 8.206316679540748 * k2[i]
        k0[i] = new0
        k1[i] = new1
        k2[i] = new2


@njit(error_model="numpy", fastmath=ORDERED, _nrt=False)
def gauss_legendre_6_sweep(kernel, t, h, x, k, y, new, work, constant):
    """Evaluate each stage from the newest others; the largest change relative to the state, or NaN."""
    d = states(constant, x)
    k0 = k[0]
    k1 = k[1]
    k2 = k[2]
    largest = 0.0
    poison = 0.0
    for i in range(d):
        y[i] = x[i] + (h * 0.1388888888888889) * k0[i] - (h * 0.03597666752493894) * k1[i] + (h * 0.009789444015308318) * k2[i]
    rhs(kernel, t + 0.1127016653792583 * h, y, new, work)
    for i in range(d):
        change = h * abs(new[i] - k0[i])
        scale = abs(x[i]) + h * abs(new[i])
        if change > largest * scale:
            largest = change / scale
        poison += 0.0 * change
        k0[i] = new[i]
    for i in range(d):
        y[i] = x[i] + (h * 0.3002631949808646) * k0[i] + (h * 0.2222222222222222) * k1[i] - (h * 0.022485417203086805) * k2[i]
    rhs(kernel, t + 0.5 * h, y, new, work)
    for i in range(d):
        change = h * abs(new[i] - k1[i])
        scale = abs(x[i]) + h * abs(new[i])
        if change > largest * scale:
            largest = change / scale
        poison += 0.0 * change
        k1[i] = new[i]
    for i in range(d):
        y[i] = x[i] + (h * 0.26798833376246944) * k0[i] + (h * 0.48042111196938336) * k1[i] + (h * 0.1388888888888889) * k2[i]
    rhs(kernel, t + 0.8872983346207417 * h, y, new, work)
    for i in range(d):
        change = h * abs(new[i] - k2[i])
        scale = abs(x[i]) + h * abs(new[i])
        if change > largest * scale:
            largest = change / scale
        poison += 0.0 * change
        k2[i] = new[i]
    return largest + poison


@njit(error_model="numpy", _nrt=False)
def gauss_legendre_6_increment(h, x, k, lost, constant):
    """Add the step to x and keep what rounding loses for the next (Kahan's summation)."""
    d = states(constant, x)
    k0 = k[0]
    k1 = k[1]
    k2 = k[2]
    for i in range(d):
        total = lost[i] + (h * 0.2777777777777778) * k0[i] + (h * 0.4444444444444444) * k1[i] + (h * 0.2777777777777778) * k2[i]
        before = x[i]
        x[i] = before + total
        lost[i] = (before - x[i]) + total
