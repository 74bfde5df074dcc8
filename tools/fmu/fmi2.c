/* The functions of FMI 2.0 for co-simulation over a unit (fmu_unit.h). What the model description does not offer - strings,
   serialised states, derivatives, model exchange - is answered with fmi2Error. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/fmu/fmi/fmi2Functions.h"
#include "tools/fmu/fmu_unit.h"

typedef struct {
  FmuUnit* unit;
  char* name;
  const fmi2CallbackFunctions* functions;
  double time; /* [s] reached */
} Instance;

static void tell(const fmi2CallbackFunctions* functions, const char* name, const char* message) {
  if (functions != NULL && functions->logger != NULL) {
    functions->logger(functions->componentEnvironment, name, fmi2Error, "logStatusError", "%s", message);
  }
}

static fmi2Status refuse(const Instance* instance, const char* message) {
  tell(instance->functions, instance->name, message);
  return fmi2Error;
}

static fmi2Status status_of(const Instance* instance, int good) {
  return good ? fmi2OK : refuse(instance, fmu_unit_message(instance->unit));
}

static fmi2Status not_offered(fmi2Component component, const char* what) {
  char message[128];
  snprintf(message, sizeof message, "%s: not offered (modelDescription.xml)", what);
  return refuse((const Instance*)component, message);
}

static int hexadecimal(char digit) {
  const char* digits = "0123456789abcdef";
  const char* place = digit == '\0' ? NULL : strchr(digits, digit >= 'A' && digit <= 'F' ? digit - 'A' + 'a' : digit);
  return place == NULL ? -1 : (int)(place - digits);
}

/* "file:///folder/with%20blank" as a path. The answer is to be freed. */
static char* path_of(const char* location) {
  const char* from = location;
  char* path;
  char* to;
  if (strncmp(from, "file:", 5) == 0) {
    from += 5;
    if (strncmp(from, "//", 2) == 0) {
      const char* slash = strchr(from + 2, '/'); /* behind the host, which is empty or localhost */
      if (slash != NULL) from = slash;
    }
  }
  path = malloc(strlen(from) + 1);
  if (path == NULL) return NULL;
  for (to = path; *from != '\0'; ++to) {
    if (*from == '%' && hexadecimal(from[1]) >= 0 && hexadecimal(from[2]) >= 0) {
      *to = (char)(16 * hexadecimal(from[1]) + hexadecimal(from[2]));
      from += 3;
    } else {
      *to = *from++;
    }
  }
  *to = '\0';
  return path;
}

const char* fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char* fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]) {
  (void)c, (void)on, (void)count, (void)categories; /* errors alone are logged, and always */
  return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location, const fmi2CallbackFunctions* functions,
                              fmi2Boolean visible, fmi2Boolean logging) {
  char message[1024] = "no folder of resources was given";
  Instance* instance;
  char* path;
  (void)visible, (void)logging;
  if (name == NULL) name = "";
  if (type != fmi2CoSimulation) {
    tell(functions, name, "this FMU is for co-simulation, not for model exchange");
    return NULL;
  }
  instance = calloc(1, sizeof *instance);
  path = location == NULL ? NULL : path_of(location);
  if (instance != NULL) {
    instance->functions = functions;
    instance->name = malloc(strlen(name) + 1);
    if (instance->name != NULL) strcpy(instance->name, name);
    if (path != NULL) instance->unit = fmu_unit_make(path, guid, message, sizeof message);
  }
  free(path);
  if (instance != NULL && instance->name != NULL && instance->unit != NULL) return instance;
  tell(functions, name, message);
  fmi2FreeInstance(instance);
  return NULL;
}

void fmi2FreeInstance(fmi2Component c) {
  Instance* instance = c;
  if (instance == NULL) return;
  fmu_unit_free(instance->unit);
  free(instance->name);
  free(instance);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start, fmi2Boolean stop_defined,
                               fmi2Real stop) {
  (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop; /* the step is fixed, the end open */
  ((Instance*)c)->time = start;
  return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  Instance* instance = c;
  return status_of(instance, fmu_unit_begin(instance->unit, instance->time));
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return status_of(c, fmu_unit_start(((Instance*)c)->unit)); }
fmi2Status fmi2Terminate(fmi2Component c) {
  (void)c;
  return fmi2OK;
}
fmi2Status fmi2Reset(fmi2Component c) {
  ((Instance*)c)->time = 0.0;
  return status_of(c, fmu_unit_reset(((Instance*)c)->unit));
}

#define ACCESS(NAME, CTYPE, TYPE)                                                                                  \
  fmi2Status fmi2Get##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t count, CTYPE value[]) {          \
    FmuUnit* unit = ((Instance*)c)->unit;                                                                          \
    size_t i;                                                                                                      \
    for (i = 0; i < count; ++i) {                                                                                  \
      double found;                                                                                                \
      if (!fmu_unit_get(unit, vr[i], TYPE, &found)) return status_of(c, 0);                                        \
      value[i] = (CTYPE)found;                                                                                     \
    }                                                                                                              \
    return fmi2OK;                                                                                                 \
  }                                                                                                                \
  fmi2Status fmi2Set##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t count, const CTYPE value[]) {    \
    FmuUnit* unit = ((Instance*)c)->unit;                                                                          \
    size_t i;                                                                                                      \
    for (i = 0; i < count; ++i) {                                                                                  \
      if (!fmu_unit_set(unit, vr[i], TYPE, (double)value[i])) return status_of(c, 0);                              \
    }                                                                                                              \
    return fmi2OK;                                                                                                 \
  }
ACCESS(Real, fmi2Real, FMU_REAL)
ACCESS(Integer, fmi2Integer, FMU_INTEGER)
ACCESS(Boolean, fmi2Boolean, FMU_BOOLEAN)

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2String value[]) {
  (void)vr, (void)value;
  return count == 0 ? fmi2OK : not_offered(c, "strings");
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2String value[]) {
  (void)vr, (void)value;
  return count == 0 ? fmi2OK : not_offered(c, "strings");
}

typedef struct {
  FmuUnit* unit;
  double time;
} State;

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* kept) {
  const Instance* instance = c;
  State* state = *kept;
  if (state == NULL) {
    state = calloc(1, sizeof *state);
    if (state == NULL) return refuse(instance, "no memory for a state");
    state->unit = fmu_unit_copy(instance->unit);
    if (state->unit == NULL) {
      free(state);
      return refuse(instance, "no memory for a state");
    }
    *kept = state;
  } else if (!fmu_unit_take_over(state->unit, instance->unit)) {
    return refuse(instance, fmu_unit_message(state->unit));
  }
  state->time = instance->time;
  return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate kept) {
  const State* state = kept;
  if (state == NULL) return refuse(c, "no state was given");
  ((Instance*)c)->time = state->time;
  return status_of(c, fmu_unit_take_over(((Instance*)c)->unit, state->unit));
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* kept) {
  State* state = kept == NULL ? NULL : *kept;
  (void)c;
  if (state == NULL) return fmi2OK;
  fmu_unit_free(state->unit);
  free(state);
  *kept = NULL;
  return fmi2OK;
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t* size) {
  (void)state, (void)size;
  return not_offered(c, "a state as bytes");
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  (void)state, (void)bytes, (void)size;
  return not_offered(c, "a state as bytes");
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate* state) {
  (void)bytes, (void)size, (void)state;
  return not_offered(c, "a state as bytes");
}
fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns, const fmi2ValueReference known[],
                                        size_t knowns, const fmi2Real change[], fmi2Real answer[]) {
  (void)unknown, (void)unknowns, (void)known, (void)knowns, (void)change, (void)answer;
  return not_offered(c, "directional derivatives");
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Integer order[],
                                       const fmi2Real value[]) {
  (void)vr, (void)count, (void)order, (void)value;
  return not_offered(c, "derivatives of inputs");
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Integer order[],
                                        fmi2Real value[]) {
  (void)vr, (void)count, (void)order, (void)value;
  return not_offered(c, "derivatives of outputs");
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean keeps_no_state) {
  Instance* instance = c;
  (void)keeps_no_state;
  if (!fmu_unit_step(instance->unit, time, step)) return status_of(instance, 0);
  instance->time = time + step;
  return fmi2OK;
}
fmi2Status fmi2CancelStep(fmi2Component c) { return not_offered(c, "a step to be cancelled"); }

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status* value) {
  (void)kind, (void)value;
  return not_offered(c, "a pending step");
}
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real* value) {
  if (kind != fmi2LastSuccessfulTime) return not_offered(c, "this status");
  *value = ((Instance*)c)->time;
  return fmi2OK;
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer* value) {
  (void)kind, (void)value;
  return not_offered(c, "this status");
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean* value) {
  if (kind != fmi2Terminated) return not_offered(c, "this status");
  *value = fmi2False;
  return fmi2OK;
}
fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String* value) {
  (void)kind, (void)value;
  return not_offered(c, "this status");
}
