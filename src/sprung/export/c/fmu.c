/* FMI 3.0 co-simulation interface of the ride model in vehicle.c. The standard's types are declared here as far as it needs them. */

#include <stdint.h>
#include <stdlib.h>
#include <stdbool.h>

#include "vehicle.c"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef uint32_t fmi3ValueReference;
typedef void (*fmi3LogMessageCallback)(void *, fmi3Status, const char *, const char *);

/* Value references: time, parameters, road under each wheel, its rate, outputs. */
enum { TIME = 0, PARAMETER = 1, ROAD = PARAMETER + N_PARAMETERS, RATE = ROAD + N_WHEELS, OUTPUT = RATE + N_WHEELS };

typedef struct {
    Vehicle vehicle;
    bool is_at_rest, is_started;
    void *environment;
    fmi3LogMessageCallback log;
} Instance;

static fmi3Status failed(Instance *instance, const char *message) {
    if (instance->log) instance->log(instance->environment, fmi3Error, "logStatusError", message);
    return fmi3Error;
}

static void restart(Instance *instance) {
    memset(&instance->vehicle, 0, sizeof instance->vehicle);
    memcpy(instance->vehicle.parameter, parameter_values, sizeof parameter_values);
    instance->vehicle.tolerance = DEFAULT_TOLERANCE;
    instance->is_at_rest = instance->is_started = false;
}

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

EXPORT fmi3Status fmi3SetDebugLogging(void *instance, bool on, size_t count, const char *const categories[]) {
    (void)instance, (void)on, (void)count, (void)categories;
    return fmi3OK;
}

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible, bool logging,
                                         bool events, bool early, const fmi3ValueReference required[], size_t count,
                                         void *environment, fmi3LogMessageCallback log, void *update) {
    (void)name, (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)required, (void)count;
    (void)update;
    Instance *instance = token && !strcmp(token, INSTANTIATION_TOKEN) ? calloc(1, sizeof(Instance)) : NULL;
    if (!instance) {
        if (log) log(environment, fmi3Error, "logStatusError", "The instantiation token is not that of the model description.");
        return NULL;
    }
    instance->environment = environment;
    instance->log = log;
    restart(instance);
    return instance;
}

EXPORT void fmi3FreeInstance(void *instance) { free(instance); }

EXPORT fmi3Status fmi3EnterInitializationMode(void *opaque, bool has_tolerance, double tolerance, double start, bool has_stop,
                                              double stop) {
    Instance *instance = opaque;
    (void)has_stop, (void)stop;
    if (has_tolerance && tolerance > 0.0) instance->vehicle.tolerance = fmin(tolerance, DEFAULT_TOLERANCE);
    instance->vehicle.time = start;
    return fmi3OK;
}

/* Outputs may be read, and parameters and inputs set, in any order before the initialisation ends. */
static bool is_ready(Instance *instance) {
    if (!instance->is_at_rest && !instance->is_started) instance->is_at_rest = initialise(&instance->vehicle);
    return instance->is_at_rest;
}

EXPORT fmi3Status fmi3ExitInitializationMode(void *opaque) {
    Instance *instance = opaque;
    instance->is_started = is_ready(instance);
    if (instance->is_started) return fmi3OK;
    return failed(instance, "The vehicle has no position of rest on this road with these parameters.");
}

EXPORT fmi3Status fmi3Terminate(void *instance) {
    (void)instance;
    return fmi3OK;
}

EXPORT fmi3Status fmi3Reset(void *instance) {
    restart(instance);
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFloat64(void *opaque, const fmi3ValueReference references[], size_t count, double values[],
                                 size_t n_values) {
    Instance *instance = opaque;
    Vehicle *vehicle = &instance->vehicle;
    double output[N_OUTPUTS];
    bool is_computed = false;
    if (n_values != count) return failed(instance, "As many values as variables are expected.");
    for (size_t i = 0; i < count; i++) {
        fmi3ValueReference at = references[i];
        if (at == TIME) values[i] = vehicle->time;
        else if (at < ROAD) values[i] = vehicle->parameter[at - PARAMETER];
        else if (at < RATE) values[i] = vehicle->road[at - ROAD];
        else if (at < OUTPUT) values[i] = vehicle->road_rate[at - RATE];
        else if (at < OUTPUT + N_OUTPUTS) {
            if (!is_ready(instance)) return failed(instance, "The vehicle has no position of rest on this road.");
            if (!is_computed) outputs_at(vehicle, output);
            is_computed = true;
            values[i] = output[at - OUTPUT];
        } else return failed(instance, "There is no variable of this value reference.");
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFloat64(void *opaque, const fmi3ValueReference references[], size_t count, const double values[],
                                 size_t n_values) {
    Instance *instance = opaque;
    Vehicle *vehicle = &instance->vehicle;
    if (n_values != count) return failed(instance, "As many values as variables are expected.");
    if (!instance->is_started) instance->is_at_rest = false;
    for (size_t i = 0; i < count; i++) {
        fmi3ValueReference at = references[i];
        if (!isfinite(values[i])) return failed(instance, "A value is not finite.");
        if (at >= PARAMETER && at < ROAD) {
            if (instance->is_started) return failed(instance, "Parameters are fixed from the initialisation on.");
            vehicle->parameter[at - PARAMETER] = values[i];
        } else if (at >= ROAD && at < RATE) vehicle->road[at - ROAD] = values[i];
        else if (at >= RATE && at < OUTPUT) vehicle->road_rate[at - RATE] = values[i];
        else return failed(instance, "Only parameters and inputs can be set.");
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3DoStep(void *opaque, double point, double size, bool no_return, bool *event, bool *terminate, bool *early,
                             double *last) {
    Instance *instance = opaque;
    (void)no_return;
    *event = *terminate = *early = false;
    instance->vehicle.time = instance->vehicle.road_time = point;
    if (!integrate(&instance->vehicle, point + size)) return failed(instance, "The motion diverges.");
    *last = instance->vehicle.time;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFMUState(void *opaque, void **state) {
    if (!*state) *state = malloc(sizeof(Instance));
    if (!*state) return failed(opaque, "No memory is left.");
    memcpy(*state, opaque, sizeof(Instance));
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFMUState(void *opaque, void *state) {
    Instance *instance = opaque, *kept = state;
    instance->vehicle = kept->vehicle;
    instance->is_at_rest = kept->is_at_rest;
    instance->is_started = kept->is_started;
    return fmi3OK;
}

EXPORT fmi3Status fmi3FreeFMUState(void *instance, void **state) {
    (void)instance;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

#define NOT_CREATED(name) EXPORT void *name(void) { return NULL; }
#define UNSUPPORTED(name) EXPORT fmi3Status name(void) { return fmi3Error; }

NOT_CREATED(fmi3InstantiateModelExchange)
NOT_CREATED(fmi3InstantiateScheduledExecution)
UNSUPPORTED(fmi3EnterEventMode)
UNSUPPORTED(fmi3GetFloat32)
UNSUPPORTED(fmi3GetInt8)
UNSUPPORTED(fmi3GetUInt8)
UNSUPPORTED(fmi3GetInt16)
UNSUPPORTED(fmi3GetUInt16)
UNSUPPORTED(fmi3GetInt32)
UNSUPPORTED(fmi3GetUInt32)
UNSUPPORTED(fmi3GetInt64)
UNSUPPORTED(fmi3GetUInt64)
UNSUPPORTED(fmi3GetBoolean)
UNSUPPORTED(fmi3GetString)
UNSUPPORTED(fmi3GetBinary)
UNSUPPORTED(fmi3GetClock)
UNSUPPORTED(fmi3SetFloat32)
UNSUPPORTED(fmi3SetInt8)
UNSUPPORTED(fmi3SetUInt8)
UNSUPPORTED(fmi3SetInt16)
UNSUPPORTED(fmi3SetUInt16)
UNSUPPORTED(fmi3SetInt32)
UNSUPPORTED(fmi3SetUInt32)
UNSUPPORTED(fmi3SetInt64)
UNSUPPORTED(fmi3SetUInt64)
UNSUPPORTED(fmi3SetBoolean)
UNSUPPORTED(fmi3SetString)
UNSUPPORTED(fmi3SetBinary)
UNSUPPORTED(fmi3SetClock)
UNSUPPORTED(fmi3GetNumberOfVariableDependencies)
UNSUPPORTED(fmi3GetVariableDependencies)
UNSUPPORTED(fmi3SerializedFMUStateSize)
UNSUPPORTED(fmi3SerializeFMUState)
UNSUPPORTED(fmi3DeserializeFMUState)
UNSUPPORTED(fmi3GetDirectionalDerivative)
UNSUPPORTED(fmi3GetAdjointDerivative)
UNSUPPORTED(fmi3EnterConfigurationMode)
UNSUPPORTED(fmi3ExitConfigurationMode)
UNSUPPORTED(fmi3GetIntervalDecimal)
UNSUPPORTED(fmi3GetIntervalFraction)
UNSUPPORTED(fmi3GetShiftDecimal)
UNSUPPORTED(fmi3GetShiftFraction)
UNSUPPORTED(fmi3SetIntervalDecimal)
UNSUPPORTED(fmi3SetIntervalFraction)
UNSUPPORTED(fmi3SetShiftDecimal)
UNSUPPORTED(fmi3SetShiftFraction)
UNSUPPORTED(fmi3EvaluateDiscreteStates)
UNSUPPORTED(fmi3UpdateDiscreteStates)
UNSUPPORTED(fmi3EnterContinuousTimeMode)
UNSUPPORTED(fmi3CompletedIntegratorStep)
UNSUPPORTED(fmi3SetTime)
UNSUPPORTED(fmi3SetContinuousStates)
UNSUPPORTED(fmi3GetContinuousStateDerivatives)
UNSUPPORTED(fmi3GetEventIndicators)
UNSUPPORTED(fmi3GetContinuousStates)
UNSUPPORTED(fmi3GetNominalsOfContinuousStates)
UNSUPPORTED(fmi3GetNumberOfEventIndicators)
UNSUPPORTED(fmi3GetNumberOfContinuousStates)
UNSUPPORTED(fmi3EnterStepMode)
UNSUPPORTED(fmi3GetOutputDerivatives)
UNSUPPORTED(fmi3ActivateModelPartition)
