/* The functions of FMI 3.0 for co-simulation over a unit (fmu_unit.h). What the model description does not offer - model exchange,
   scheduled execution, clocks, strings, serialised states, derivatives - is answered with fmi3Error. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/fmu/fmi/fmi3Functions.h"
#include "tools/fmu/fmu_unit.h"

typedef struct {
  FmuUnit* unit;
  fmi3InstanceEnvironment environment;
  fmi3LogMessageCallback log;
} Instance;

static void tell(fmi3LogMessageCallback log, fmi3InstanceEnvironment environment, const char* message) {
  if (log != NULL) log(environment, fmi3Error, "logStatusError", message);
}

static fmi3Status refuse(const Instance* instance, const char* message) {
  tell(instance->log, instance->environment, message);
  return fmi3Error;
}

static fmi3Status status_of(const Instance* instance, int good) {
  return good ? fmi3OK : refuse(instance, fmu_unit_message(instance->unit));
}

static fmi3Status not_offered(fmi3Instance instance, const char* what) {
  char message[128];
  snprintf(message, sizeof message, "%s: not offered (modelDescription.xml)", what);
  return refuse((const Instance*)instance, message);
}

const char* fmi3GetVersion(void) { return fmi3Version; }
fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t count, const fmi3String categories[]) {
  (void)instance, (void)on, (void)count, (void)categories; /* errors alone are logged, and always */
  return fmi3OK;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                         fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                                         size_t intermediates, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update) {
  char message[1024] = "no folder of resources was given";
  Instance* instance = calloc(1, sizeof *instance);
  (void)name, (void)visible, (void)logging, (void)event_mode, (void)early_return, (void)intermediate, (void)intermediates, (void)update;
  if (instance == NULL) return NULL;
  instance->environment = environment;
  instance->log = log;
  if (resources != NULL) instance->unit = fmu_unit_make(resources, token, message, sizeof message);
  if (instance->unit != NULL) return instance;
  tell(log, environment, message);
  free(instance);
  return NULL;
}
fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging;
  tell(log, environment, "this FMU is for co-simulation, not for model exchange");
  return NULL;
}
fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                               fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback clock, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)clock, (void)lock, (void)unlock;
  tell(log, environment, "this FMU is for co-simulation, not for scheduled execution");
  return NULL;
}
void fmi3FreeInstance(fmi3Instance kept) {
  Instance* instance = kept;
  if (instance == NULL) return;
  fmu_unit_free(instance->unit);
  free(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined, fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean stop_defined, fmi3Float64 stop) {
  (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop; /* the step is fixed, the end open */
  return status_of(instance, fmu_unit_begin(((Instance*)instance)->unit, start));
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  return status_of(instance, fmu_unit_start(((Instance*)instance)->unit));
}
fmi3Status fmi3Terminate(fmi3Instance instance) {
  (void)instance;
  return fmi3OK;
}
fmi3Status fmi3Reset(fmi3Instance instance) { return status_of(instance, fmu_unit_reset(((Instance*)instance)->unit)); }

#define ACCESS(NAME, TYPE)                                                                                                          \
  fmi3Status fmi3Get##NAME(fmi3Instance instance, const fmi3ValueReference vr[], size_t count, fmi3##NAME values[], size_t room) {   \
    FmuUnit* unit = ((Instance*)instance)->unit;                                                                                    \
    size_t i;                                                                                                                       \
    if (room != count) return refuse(instance, "every variable is a scalar: as many values as value references are needed");        \
    for (i = 0; i < count; ++i) {                                                                                                   \
      double found;                                                                                                                 \
      if (!fmu_unit_get(unit, vr[i], TYPE, &found)) return status_of(instance, 0);                                                  \
      values[i] = (fmi3##NAME)found;                                                                                                \
    }                                                                                                                               \
    return fmi3OK;                                                                                                                  \
  }                                                                                                                                 \
  fmi3Status fmi3Set##NAME(fmi3Instance instance, const fmi3ValueReference vr[], size_t count, const fmi3##NAME values[],           \
                           size_t given) {                                                                                          \
    FmuUnit* unit = ((Instance*)instance)->unit;                                                                                    \
    size_t i;                                                                                                                       \
    if (given != count) return refuse(instance, "every variable is a scalar: as many values as value references are needed");       \
    for (i = 0; i < count; ++i) {                                                                                                   \
      if (!fmu_unit_set(unit, vr[i], TYPE, (double)values[i])) return status_of(instance, 0);                                       \
    }                                                                                                                               \
    return fmi3OK;                                                                                                                  \
  }
ACCESS(Float64, FMU_REAL)
ACCESS(Int64, FMU_INTEGER)
ACCESS(Boolean, FMU_BOOLEAN)

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* kept) {
  FmuUnit* unit = ((Instance*)instance)->unit;
  if (*kept != NULL) return status_of(instance, fmu_unit_take_over(*kept, unit));
  *kept = fmu_unit_copy(unit);
  return *kept != NULL ? fmi3OK : refuse(instance, "no memory for a state");
}
fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState kept) {
  if (kept == NULL) return refuse(instance, "no state was given");
  return status_of(instance, fmu_unit_take_over(((Instance*)instance)->unit, kept));
}
fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState* kept) {
  (void)instance;
  if (kept == NULL) return fmi3OK;
  fmu_unit_free(*kept);
  *kept = NULL;
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step, fmi3Boolean keeps_no_state, fmi3Boolean* event,
                      fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64* reached) {
  const int good = fmu_unit_step(((Instance*)instance)->unit, time, step);
  (void)keeps_no_state;
  if (event != NULL) *event = fmi3False;
  if (terminate != NULL) *terminate = fmi3False;
  if (early != NULL) *early = fmi3False;
  if (reached != NULL) *reached = good ? time + step : time;
  return status_of(instance, good);
}

/* Not offered. */

fmi3Status fmi3SetInt32(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3Int32
                        values[], size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3SetInt32");
}
fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3Int32 values[],
                        size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3GetInt32");
}
fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  return not_offered(instance, "fmi3EnterEventMode");
}
fmi3Status fmi3GetFloat32(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3Float32 values[],
                          size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3GetFloat32");
}
fmi3Status fmi3GetInt8(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3Int8 values[], size_t
                       nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3GetInt8");
}
fmi3Status fmi3GetUInt8(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3UInt8 values[],
                        size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3GetUInt8");
}
fmi3Status fmi3GetInt16(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3Int16 values[],
                        size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3GetInt16");
}
fmi3Status fmi3GetUInt16(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3UInt16 values[],
                         size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3GetUInt16");
}
fmi3Status fmi3GetUInt32(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3UInt32 values[],
                         size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3GetUInt32");
}
fmi3Status fmi3GetUInt64(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3UInt64 values[],
                         size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3GetUInt64");
}
fmi3Status fmi3GetString(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3String values[],
                         size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3GetString");
}
fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, size_t valueSizes[],
                         fmi3Binary values[], size_t nValues) {
  (void)valueReferences, (void)valueSizes, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3GetBinary");
}
fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3Clock values[]) {
  (void)valueReferences, (void)values;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3GetClock");
}
fmi3Status fmi3SetFloat32(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3Float32
                          values[], size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3SetFloat32");
}
fmi3Status fmi3SetInt8(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3Int8 values[],
                       size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3SetInt8");
}
fmi3Status fmi3SetUInt8(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3UInt8
                        values[], size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3SetUInt8");
}
fmi3Status fmi3SetInt16(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3Int16
                        values[], size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3SetInt16");
}
fmi3Status fmi3SetUInt16(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3UInt16
                         values[], size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3SetUInt16");
}
fmi3Status fmi3SetUInt32(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3UInt32
                         values[], size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3SetUInt32");
}
fmi3Status fmi3SetUInt64(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3UInt64
                         values[], size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3SetUInt64");
}
fmi3Status fmi3SetString(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3String
                         values[], size_t nValues) {
  (void)valueReferences, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3SetString");
}
fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const size_t
                         valueSizes[], const fmi3Binary values[], size_t nValues) {
  (void)valueReferences, (void)valueSizes, (void)values, (void)nValues;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3SetBinary");
}
fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3Clock
                        values[]) {
  (void)valueReferences, (void)values;
  return nValueReferences == 0 ? fmi3OK : not_offered(instance, "fmi3SetClock");
}
fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference valueReference, size_t* nDependencies) {
  (void)valueReference, (void)nDependencies;
  return not_offered(instance, "fmi3GetNumberOfVariableDependencies");
}
fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent, size_t elementIndicesOfDependent[],
                                       fmi3ValueReference independents[], size_t elementIndicesOfIndependents[], fmi3DependencyKind
                                       dependencyKinds[], size_t nDependencies) {
    (void)dependent, (void)elementIndicesOfDependent, (void)independents, (void)elementIndicesOfIndependents, (void)dependencyKinds,
      (void)nDependencies;
  return not_offered(instance, "fmi3GetVariableDependencies");
}
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState FMUState, size_t* size) {
  (void)FMUState, (void)size;
  return not_offered(instance, "fmi3SerializedFMUStateSize");
}
fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size) {
  (void)FMUState, (void)serializedState, (void)size;
  return not_offered(instance, "fmi3SerializeFMUState");
}
fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte serializedState[], size_t size, fmi3FMUState* FMUState) {
  (void)serializedState, (void)size, (void)FMUState;
  return not_offered(instance, "fmi3DeserializeFMUState");
}
fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns, const
                                        fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64
                                        sensitivity[], size_t nSensitivity) {
  (void)unknowns, (void)nUnknowns, (void)knowns, (void)nKnowns, (void)seed, (void)nSeed, (void)sensitivity, (void)nSensitivity;
  return not_offered(instance, "fmi3GetDirectionalDerivative");
}
fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns, const fmi3ValueReference
                                    knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t
                                    nSensitivity) {
  (void)unknowns, (void)nUnknowns, (void)knowns, (void)nKnowns, (void)seed, (void)nSeed, (void)sensitivity, (void)nSensitivity;
  return not_offered(instance, "fmi3GetAdjointDerivative");
}
fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
  return not_offered(instance, "fmi3EnterConfigurationMode");
}
fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
  return not_offered(instance, "fmi3ExitConfigurationMode");
}
fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3Float64
                                  intervals[], fmi3IntervalQualifier qualifiers[]) {
  (void)valueReferences, (void)nValueReferences, (void)intervals, (void)qualifiers;
  return not_offered(instance, "fmi3GetIntervalDecimal");
}
fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3UInt64
                                   counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]) {
  (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions, (void)qualifiers;
  return not_offered(instance, "fmi3GetIntervalFraction");
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3Float64
                               shifts[]) {
  (void)valueReferences, (void)nValueReferences, (void)shifts;
  return not_offered(instance, "fmi3GetShiftDecimal");
}
fmi3Status fmi3GetShiftFraction(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3UInt64
                                counters[], fmi3UInt64 resolutions[]) {
  (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
  return not_offered(instance, "fmi3GetShiftFraction");
}
fmi3Status fmi3SetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const
                                  fmi3Float64 intervals[]) {
  (void)valueReferences, (void)nValueReferences, (void)intervals;
  return not_offered(instance, "fmi3SetIntervalDecimal");
}
fmi3Status fmi3SetIntervalFraction(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const
                                   fmi3UInt64 counters[], const fmi3UInt64 resolutions[]) {
  (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
  return not_offered(instance, "fmi3SetIntervalFraction");
}
fmi3Status fmi3SetShiftDecimal(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3Float64
                               shifts[]) {
  (void)valueReferences, (void)nValueReferences, (void)shifts;
  return not_offered(instance, "fmi3SetShiftDecimal");
}
fmi3Status fmi3SetShiftFraction(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const fmi3UInt64
                                counters[], const fmi3UInt64 resolutions[]) {
  (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
  return not_offered(instance, "fmi3SetShiftFraction");
}
fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
  return not_offered(instance, "fmi3EvaluateDiscreteStates");
}
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean* discreteStatesNeedUpdate, fmi3Boolean* terminateSimulation,
                                    fmi3Boolean* nominalsOfContinuousStatesChanged, fmi3Boolean* valuesOfContinuousStatesChanged,
                                    fmi3Boolean* nextEventTimeDefined, fmi3Float64* nextEventTime) {
    (void)discreteStatesNeedUpdate, (void)terminateSimulation, (void)nominalsOfContinuousStatesChanged,
      (void)valuesOfContinuousStatesChanged, (void)nextEventTimeDefined, (void)nextEventTime;
  return not_offered(instance, "fmi3UpdateDiscreteStates");
}
fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
  return not_offered(instance, "fmi3EnterContinuousTimeMode");
}
fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean* enterEventMode,
                                       fmi3Boolean* terminateSimulation) {
  (void)noSetFMUStatePriorToCurrentPoint, (void)enterEventMode, (void)terminateSimulation;
  return not_offered(instance, "fmi3CompletedIntegratorStep");
}
fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
  (void)time;
  return not_offered(instance, "fmi3SetTime");
}
fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 continuousStates[], size_t nContinuousStates) {
  (void)continuousStates, (void)nContinuousStates;
  return not_offered(instance, "fmi3SetContinuousStates");
}
fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 derivatives[], size_t nContinuousStates) {
  (void)derivatives, (void)nContinuousStates;
  return not_offered(instance, "fmi3GetContinuousStateDerivatives");
}
fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 eventIndicators[], size_t nEventIndicators) {
  (void)eventIndicators, (void)nEventIndicators;
  return not_offered(instance, "fmi3GetEventIndicators");
}
fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 continuousStates[], size_t nContinuousStates) {
  (void)continuousStates, (void)nContinuousStates;
  return not_offered(instance, "fmi3GetContinuousStates");
}
fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 nominals[], size_t nContinuousStates) {
  (void)nominals, (void)nContinuousStates;
  return not_offered(instance, "fmi3GetNominalsOfContinuousStates");
}
fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t* nEventIndicators) {
  (void)nEventIndicators;
  return not_offered(instance, "fmi3GetNumberOfEventIndicators");
}
fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t* nContinuousStates) {
  (void)nContinuousStates;
  return not_offered(instance, "fmi3GetNumberOfContinuousStates");
}
fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
  return not_offered(instance, "fmi3EnterStepMode");
}
fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, const
                                    fmi3Int32 orders[], fmi3Float64 values[], size_t nValues) {
  (void)valueReferences, (void)nValueReferences, (void)orders, (void)values, (void)nValues;
  return not_offered(instance, "fmi3GetOutputDerivatives");
}
fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clockReference, fmi3Float64 activationTime) {
  (void)clockReference, (void)activationTime;
  return not_offered(instance, "fmi3ActivateModelPartition");
}
