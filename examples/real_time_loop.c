/* A surrogate as a C header in a real-time loop: every PERIOD_S one cycle, which pushes the first coordinate,
   steps the surrogate, and reads its outputs. Prints where the tip is and the worst cycle of all.

   cc -std=c99 -O2 -o real_time_loop real_time_loop.c -lm       with strip.h beside it */

#define _POSIX_C_SOURCE 200809L

#include <stdio.h>
#include <time.h>

#include "strip.h"

#define PERIOD_S 1e-3
#define CYCLES 1000

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void sleep_until(double moment)
{
    const double left = moment - seconds();
    if (left > 0.0) {
        const struct timespec pause = {(time_t)left, (long)(1e9 * (left - (double)(time_t)left))};
        nanosleep(&pause, NULL);
    }
}

int main(void)
{
    const int steps = (int)(PERIOD_S / STRIP_STEP_S) + 1;
    double x[STRIP_STATES], u[STRIP_INPUTS], y[STRIP_OUTPUTS] = {0};
    double worst = 0.0, total = 0.0;
    int late = 0;
    strip_start(x, u);
    const double first = seconds();
    for (int cycle = 0; cycle < CYCLES; cycle++) {
        sleep_until(first + cycle * PERIOD_S);
        const double begun = seconds();
        u[0] = cycle < CYCLES / 2 ? 2.0 : 0.0;
        for (int step = 0; step < steps; step++)
            strip_step(x, u, PERIOD_S / steps);
        strip_outputs(x, u, y);
        const double taken = seconds() - begun;
        total += taken;
        worst = taken > worst ? taken : worst;
        late += taken > PERIOD_S;
    }
    for (int i = 0; i < STRIP_OUTPUTS; i++)
        printf("%-14s %12.5g %s\n", strip_output_name(i), y[i], strip_output_unit(i));
    printf("%d cycles of %g ms, %d steps in each: worst %.1f us, mean %.2f us, %d late; %s its range\n", CYCLES,
           1e3 * PERIOD_S, steps, 1e6 * worst, 1e6 * total / CYCLES, late, strip_within(x) ? "within" : "out of");
    return 0;
}
