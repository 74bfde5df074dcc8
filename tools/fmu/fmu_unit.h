/* What an FMU of slewlab holds, as the functions of FMI 2 and FMI 3 (fmi2.c, fmi3.c) need it: a plant or a controller with its
   variables, called a unit. Plain C; every function of it is safe for any argument but a dangling pointer, throws nothing, and where
   it refuses says why in words (fmu_unit_message). Values travel as double: integers of the units stay below 2^53. */
#ifndef SLEWLAB_FMU_UNIT_H
#define SLEWLAB_FMU_UNIT_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct FmuUnit FmuUnit;

enum FmuType { FMU_REAL, FMU_INTEGER, FMU_BOOLEAN };

/* `resources` is the folder with unit.json, `token` what the model description says (GUID, instantiation token). NULL where the
   unit cannot be made; then the first `size` bytes of the reason are in `message`. */
FmuUnit* fmu_unit_make(const char* resources, const char* token, char* message, size_t size);
void fmu_unit_free(FmuUnit* unit);

/* A copy that runs on as the original would; NULL where memory is out. */
FmuUnit* fmu_unit_copy(const FmuUnit* unit);

/* These answer with 1, or with 0 and a message. */
int fmu_unit_get(FmuUnit* unit, unsigned reference, enum FmuType type, double* value);
int fmu_unit_set(FmuUnit* unit, unsigned reference, enum FmuType type, double value);
int fmu_unit_take_over(FmuUnit* unit, const FmuUnit* from); /* becomes as `from` is */
int fmu_unit_reset(FmuUnit* unit);                          /* as it was made */
int fmu_unit_begin(FmuUnit* unit, double time);             /* enters initialization at `time` [s] */
int fmu_unit_start(FmuUnit* unit);                          /* ends it: parameters stand from now on */
int fmu_unit_step(FmuUnit* unit, double time, double step); /* [s] from `time` on; allocates nothing */

/* Why the last call of this unit answered with 0. */
const char* fmu_unit_message(const FmuUnit* unit);

#ifdef __cplusplus
}
#endif

#endif
