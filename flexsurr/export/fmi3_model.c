/* The functions of FMI 3.0 (fmi-standard.org) around a model of flexsurr, for model exchange and co-simulation.

   model.h beside this file is the model, its functions named model_*. MODEL_TOKEN is what the model description
   has as its instantiation token. Value references: 0 is time; then come the states, their derivatives, the
   inputs, the outputs, and the longest internal step of the co-simulation. Where FMI3_FUNCTION_PREFIX is
   defined it stands before the name of each function, as static linking wants it. */

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

#if defined(FMI3_FUNCTION_PREFIX) && !defined(FMI3_OVERRIDE_FUNCTION_PREFIX)
#define PASTE(a, b) a##b
#define NAMED(a, b) PASTE(a, b)
#define FMI(name) NAMED(FMI3_FUNCTION_PREFIX, fmi3##name)
#else
#define FMI(name) fmi3##name
#endif

enum {
    D = MODEL_STATES,
    FIRST_STATE = 1,
    FIRST_RATE = FIRST_STATE + D,
    FIRST_INPUT = FIRST_RATE + D,
    FIRST_OUTPUT = FIRST_INPUT + MODEL_INPUTS,
    INTERNAL_STEP = FIRST_OUTPUT + MODEL_OUTPUTS
};

typedef enum { OK, WARNING, DISCARD, ERROR, FATAL } Status;
typedef enum { INTERVAL_NOT_YET_KNOWN, INTERVAL_UNCHANGED, INTERVAL_CHANGED } Interval;
typedef enum { INDEPENDENT, CONSTANT, FIXED, TUNABLE, DISCRETE, DEPENDENT } Dependency;
typedef void *Instance;
typedef void *State;
typedef void *Environment;
typedef const char *Text;
typedef uint32_t Reference;
typedef void (*Log)(Environment, Status, Text category, Text message);
typedef void (*IntermediateUpdate)(Environment, double, bool, bool, bool, bool, bool *, double *);
typedef void (*ClockUpdate)(Environment);
typedef void (*Lock)(void);

/* What a simulation consists of: all that fmi3GetFMUState keeps. */
typedef struct {
    double time;
    double step;
    double x[D + 1];
    double u[MODEL_INPUTS + 1];
} Values;

typedef struct {
    Values now;
    Environment environment;
    Log log;
} Model;

static Status failed(const Model *model, Text message)
{
    if (model != NULL && model->log != NULL)
        model->log(model->environment, ERROR, "error", message);
    return ERROR;
}

static void rates_of(const Values *now, double *dx)
{
#if MODEL_STATES > 0
    model_rates(now->x, now->u, dx);
#else
    (void)now;
    (void)dx;
#endif
}

static void outputs_of(const Values *now, double *y)
{
#if MODEL_STATES > 0
    model_outputs(now->x, now->u, y);
#else
    model_outputs(now->u, y);
#endif
}

static void start(Values *now)
{
    memset(now, 0, sizeof *now);
#if MODEL_STATES > 0
    model_start(now->x, now->u);
    now->step = MODEL_STEP_S;
#else
    model_start(now->u);
#endif
}

static Instance instantiated(Text token, Environment environment, Log log)
{
    Model *model;
    if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
        if (log != NULL)
            log(environment, ERROR, "error", "the instantiation token is that of another model");
        return NULL;
    }
    model = malloc(sizeof *model);
    if (model == NULL)
        return NULL;
    start(&model->now);
    model->environment = environment;
    model->log = log;
    return model;
}

/* Creation and modes */

EXPORT const char *FMI(GetVersion)(void)
{
    return "3.0";
}

EXPORT Status FMI(SetDebugLogging)(Instance instance, bool on, size_t n, const Text categories[])
{
    (void)instance, (void)on, (void)n, (void)categories;
    return OK;
}

EXPORT Instance FMI(InstantiateModelExchange)(Text name, Text token, Text resources, bool visible, bool logging,
                                              Environment environment, Log log)
{
    (void)name, (void)resources, (void)visible, (void)logging;
    return instantiated(token, environment, log);
}

EXPORT Instance FMI(InstantiateCoSimulation)(Text name, Text token, Text resources, bool visible, bool logging,
                                             bool events, bool early, const Reference intermediate[], size_t n,
                                             Environment environment, Log log, IntermediateUpdate update)
{
    (void)name, (void)resources, (void)visible, (void)logging, (void)events, (void)early;
    (void)intermediate, (void)n, (void)update;
    return instantiated(token, environment, log);
}

EXPORT Instance FMI(InstantiateScheduledExecution)(Text name, Text token, Text resources, bool visible,
                                                   bool logging, Environment environment, Log log,
                                                   ClockUpdate update, Lock lock, Lock unlock)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging;
    (void)update, (void)lock, (void)unlock;
    if (log != NULL)
        log(environment, ERROR, "error", "there is no scheduled execution");
    return NULL;
}

EXPORT void FMI(FreeInstance)(Instance instance)
{
    free(instance);
}

EXPORT Status FMI(EnterInitializationMode)(Instance instance, bool has_tolerance, double tolerance, double first,
                                           bool has_last, double last)
{
    (void)has_tolerance, (void)tolerance, (void)has_last, (void)last;
    ((Model *)instance)->now.time = first;
    return OK;
}

EXPORT Status FMI(Reset)(Instance instance)
{
    start(&((Model *)instance)->now);
    return OK;
}

#define NOTHING_TO_DO(name)                                                                                    \
    EXPORT Status FMI(name)(Instance instance)                                                                 \
    {                                                                                                          \
        (void)instance;                                                                                        \
        return OK;                                                                                             \
    }

NOTHING_TO_DO(ExitInitializationMode)
NOTHING_TO_DO(EnterEventMode)
NOTHING_TO_DO(Terminate)
NOTHING_TO_DO(EnterConfigurationMode)
NOTHING_TO_DO(ExitConfigurationMode)
NOTHING_TO_DO(EvaluateDiscreteStates)
NOTHING_TO_DO(EnterContinuousTimeMode)
NOTHING_TO_DO(EnterStepMode)

EXPORT Status FMI(UpdateDiscreteStates)(Instance instance, bool *again, bool *end, bool *nominals, bool *states,
                                        bool *has_next, double *next)
{
    (void)instance, (void)next;
    *again = *end = *nominals = *states = *has_next = false;
    return OK;
}

/* Variables */

EXPORT Status FMI(GetFloat64)(Instance instance, const Reference references[], size_t n, double values[],
                              size_t count)
{
    const Values *now = &((Model *)instance)->now;
    double dx[D + 1], y[MODEL_OUTPUTS + 1];
    bool rates = false, outputs = false;
    if (n != count)
        return failed(instance, "a number for each value reference is needed");
    for (size_t i = 0; i < n; i++) {
        const Reference at = references[i];
        if (at == 0) {
            values[i] = now->time;
        } else if (at < FIRST_RATE) {
            values[i] = now->x[at - FIRST_STATE];
        } else if (at < FIRST_INPUT) {
            if (!rates)
                rates_of(now, dx);
            rates = true;
            values[i] = dx[at - FIRST_RATE];
        } else if (at < FIRST_OUTPUT) {
            values[i] = now->u[at - FIRST_INPUT];
        } else if (at < INTERNAL_STEP) {
            if (!outputs)
                outputs_of(now, y);
            outputs = true;
            values[i] = y[at - FIRST_OUTPUT];
        } else if (at == INTERNAL_STEP && D > 0) {
            values[i] = now->step;
        } else {
            return failed(instance, "there is no variable of this value reference");
        }
    }
    return OK;
}

EXPORT Status FMI(SetFloat64)(Instance instance, const Reference references[], size_t n, const double values[],
                              size_t count)
{
    Values *now = &((Model *)instance)->now;
    if (n != count)
        return failed(instance, "a number for each value reference is needed");
    for (size_t i = 0; i < n; i++) {
        const Reference at = references[i];
        if (at >= FIRST_STATE && at < FIRST_RATE)
            now->x[at - FIRST_STATE] = values[i];
        else if (at >= FIRST_INPUT && at < FIRST_OUTPUT)
            now->u[at - FIRST_INPUT] = values[i];
        else if (at == INTERNAL_STEP && D > 0 && values[i] > 0.0)
            now->step = values[i];
        else
            return failed(instance, "only states, inputs and a positive internal step can be set");
    }
    return OK;
}

#define NO_VARIABLES(type, number)                                                                             \
    EXPORT Status FMI(Get##type)(Instance instance, const Reference references[], size_t n, number values[],   \
                                 size_t count)                                                                 \
    {                                                                                                          \
        (void)references, (void)values, (void)count;                                                           \
        return n == 0 ? OK : failed(instance, "there are no variables of the type " #type);                    \
    }                                                                                                          \
    EXPORT Status FMI(Set##type)(Instance instance, const Reference references[], size_t n,                    \
                                 const number values[], size_t count)                                          \
    {                                                                                                          \
        (void)references, (void)values, (void)count;                                                           \
        return n == 0 ? OK : failed(instance, "there are no variables of the type " #type);                    \
    }

NO_VARIABLES(Float32, float)
NO_VARIABLES(Int8, int8_t)
NO_VARIABLES(UInt8, uint8_t)
NO_VARIABLES(Int16, int16_t)
NO_VARIABLES(UInt16, uint16_t)
NO_VARIABLES(Int32, int32_t)
NO_VARIABLES(UInt32, uint32_t)
NO_VARIABLES(Int64, int64_t)
NO_VARIABLES(UInt64, uint64_t)
NO_VARIABLES(Boolean, bool)
NO_VARIABLES(String, Text)

EXPORT Status FMI(GetBinary)(Instance instance, const Reference references[], size_t n, size_t sizes[],
                             const uint8_t *values[], size_t count)
{
    (void)references, (void)sizes, (void)values, (void)count;
    return n == 0 ? OK : failed(instance, "there are no variables of the type Binary");
}

EXPORT Status FMI(SetBinary)(Instance instance, const Reference references[], size_t n, const size_t sizes[],
                             const uint8_t *const values[], size_t count)
{
    (void)references, (void)sizes, (void)values, (void)count;
    return n == 0 ? OK : failed(instance, "there are no variables of the type Binary");
}

EXPORT Status FMI(GetClock)(Instance instance, const Reference references[], size_t n, bool values[])
{
    (void)references, (void)values;
    return n == 0 ? OK : failed(instance, "there are no clocks");
}

EXPORT Status FMI(SetClock)(Instance instance, const Reference references[], size_t n, const bool values[])
{
    (void)references, (void)values;
    return n == 0 ? OK : failed(instance, "there are no clocks");
}

/* A simulation kept, and taken up again */

EXPORT Status FMI(GetFMUState)(Instance instance, State *state)
{
    if (*state == NULL)
        *state = malloc(sizeof(Values));
    if (*state == NULL)
        return failed(instance, "out of memory");
    memcpy(*state, &((Model *)instance)->now, sizeof(Values));
    return OK;
}

EXPORT Status FMI(SetFMUState)(Instance instance, State state)
{
    memcpy(&((Model *)instance)->now, state, sizeof(Values));
    return OK;
}

EXPORT Status FMI(FreeFMUState)(Instance instance, State *state)
{
    (void)instance;
    free(*state);
    *state = NULL;
    return OK;
}

EXPORT Status FMI(SerializedFMUStateSize)(Instance instance, State state, size_t *size)
{
    (void)instance, (void)state;
    *size = sizeof(Values);
    return OK;
}

EXPORT Status FMI(SerializeFMUState)(Instance instance, State state, uint8_t bytes[], size_t size)
{
    if (size < sizeof(Values))
        return failed(instance, "too little room for a state");
    memcpy(bytes, state, sizeof(Values));
    return OK;
}

EXPORT Status FMI(DeserializeFMUState)(Instance instance, const uint8_t bytes[], size_t size, State *state)
{
    if (size < sizeof(Values))
        return failed(instance, "these bytes are no state");
    if (*state == NULL)
        *state = malloc(sizeof(Values));
    if (*state == NULL)
        return failed(instance, "out of memory");
    memcpy(*state, bytes, sizeof(Values));
    return OK;
}

/* Model exchange */

EXPORT Status FMI(SetTime)(Instance instance, double time)
{
    ((Model *)instance)->now.time = time;
    return OK;
}

EXPORT Status FMI(SetContinuousStates)(Instance instance, const double states[], size_t n)
{
    if (n != D)
        return failed(instance, "a number for each state is needed");
    memcpy(((Model *)instance)->now.x, states, n * sizeof(double));
    return OK;
}

EXPORT Status FMI(GetContinuousStates)(Instance instance, double states[], size_t n)
{
    if (n != D)
        return failed(instance, "room for each state is needed");
    memcpy(states, ((Model *)instance)->now.x, n * sizeof(double));
    return OK;
}

EXPORT Status FMI(GetContinuousStateDerivatives)(Instance instance, double derivatives[], size_t n)
{
    if (n != D)
        return failed(instance, "room for each derivative is needed");
    rates_of(&((Model *)instance)->now, derivatives);
    return OK;
}

EXPORT Status FMI(GetNominalsOfContinuousStates)(Instance instance, double nominals[], size_t n)
{
    static const double known[] = {MODEL_NOMINALS};
    if (n != D)
        return failed(instance, "room for each state is needed");
    memcpy(nominals, known, n * sizeof(double));
    return OK;
}

EXPORT Status FMI(GetNumberOfContinuousStates)(Instance instance, size_t *n)
{
    (void)instance;
    *n = D;
    return OK;
}

EXPORT Status FMI(GetNumberOfEventIndicators)(Instance instance, size_t *n)
{
    (void)instance;
    *n = 0;
    return OK;
}

EXPORT Status FMI(GetEventIndicators)(Instance instance, double indicators[], size_t n)
{
    (void)indicators;
    return n == 0 ? OK : failed(instance, "there are no event indicators");
}

EXPORT Status FMI(CompletedIntegratorStep)(Instance instance, bool no_way_back, bool *event, bool *end)
{
    (void)instance, (void)no_way_back;
    *event = *end = false;
    return OK;
}

/* Co-simulation: equal steps, none longer than the internal step, with the inputs held */

EXPORT Status FMI(DoStep)(Instance instance, double time, double length, bool no_way_back, bool *event, bool *end,
                          bool *early, double *reached)
{
    Model *model = instance;
    (void)no_way_back;
    *event = *end = *early = false;
#if MODEL_STATES > 0
    const double steps = fmax(1.0, ceil(length / model->now.step - 1e-9));
    for (double k = 0.0; k < steps; k += 1.0)
        model_step(model->now.x, model->now.u, length / steps);
    for (int i = 0; i < D; i++) {
        if (!isfinite(model->now.x[i])) {
            *reached = time;
            return failed(model, "a state is no longer a finite number");
        }
    }
#endif
    model->now.time = time + length;
    *reached = model->now.time;
    return OK;
}

EXPORT Status FMI(GetOutputDerivatives)(Instance instance, const Reference references[], size_t n,
                                        const int32_t orders[], double values[], size_t count)
{
    (void)references, (void)n, (void)orders, (void)values, (void)count;
    return failed(instance, "there are no derivatives of outputs");
}

/* What the model description says that there is not */

EXPORT Status FMI(GetNumberOfVariableDependencies)(Instance instance, Reference reference, size_t *n)
{
    (void)reference, (void)n;
    return failed(instance, "there are no dependencies by element");
}

EXPORT Status FMI(GetVariableDependencies)(Instance instance, Reference dependent, size_t of_dependent[],
                                           Reference independents[], size_t of_independents[], Dependency kinds[],
                                           size_t n)
{
    (void)dependent, (void)of_dependent, (void)independents, (void)of_independents, (void)kinds, (void)n;
    return failed(instance, "there are no dependencies by element");
}

#define NO_DERIVATIVE(name)                                                                                    \
    EXPORT Status FMI(name)(Instance instance, const Reference unknowns[], size_t n_unknowns,                  \
                            const Reference knowns[], size_t n_knowns, const double seed[], size_t n_seed,     \
                            double sensitivity[], size_t n_sensitivity)                                        \
    {                                                                                                          \
        (void)unknowns, (void)n_unknowns, (void)knowns, (void)n_knowns, (void)seed, (void)n_seed;              \
        (void)sensitivity, (void)n_sensitivity;                                                                \
        return failed(instance, "there are no derivatives of the equations");                                  \
    }

NO_DERIVATIVE(GetDirectionalDerivative)
NO_DERIVATIVE(GetAdjointDerivative)

EXPORT Status FMI(GetIntervalDecimal)(Instance instance, const Reference references[], size_t n,
                                      double intervals[], Interval qualifiers[])
{
    (void)references, (void)n, (void)intervals, (void)qualifiers;
    return failed(instance, "there are no clocks");
}

EXPORT Status FMI(GetIntervalFraction)(Instance instance, const Reference references[], size_t n,
                                       uint64_t counters[], uint64_t resolutions[], Interval qualifiers[])
{
    (void)references, (void)n, (void)counters, (void)resolutions, (void)qualifiers;
    return failed(instance, "there are no clocks");
}

EXPORT Status FMI(GetShiftDecimal)(Instance instance, const Reference references[], size_t n, double shifts[])
{
    (void)references, (void)n, (void)shifts;
    return failed(instance, "there are no clocks");
}

EXPORT Status FMI(GetShiftFraction)(Instance instance, const Reference references[], size_t n,
                                    uint64_t counters[], uint64_t resolutions[])
{
    (void)references, (void)n, (void)counters, (void)resolutions;
    return failed(instance, "there are no clocks");
}

#define NO_DECIMALS(name)                                                                                      \
    EXPORT Status FMI(name)(Instance instance, const Reference references[], size_t n, const double given[])   \
    {                                                                                                          \
        (void)references, (void)n, (void)given;                                                                \
        return failed(instance, "there are no clocks");                                                        \
    }

#define NO_FRACTIONS(name)                                                                                     \
    EXPORT Status FMI(name)(Instance instance, const Reference references[], size_t n,                         \
                            const uint64_t counters[], const uint64_t resolutions[])                           \
    {                                                                                                          \
        (void)references, (void)n, (void)counters, (void)resolutions;                                          \
        return failed(instance, "there are no clocks");                                                        \
    }

NO_DECIMALS(SetIntervalDecimal)
NO_DECIMALS(SetShiftDecimal)
NO_FRACTIONS(SetIntervalFraction)
NO_FRACTIONS(SetShiftFraction)

EXPORT Status FMI(ActivateModelPartition)(Instance instance, Reference clock, double time)
{
    (void)clock, (void)time;
    return failed(instance, "there is no scheduled execution");
}
