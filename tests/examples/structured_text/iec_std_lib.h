/* What the C code of translate.py needs of IEC 61131-3: types, the clock, and the timer TON. The names are those that MatIEC's own
 * header of this name has, which belongs to MatIEC and is not here. */
#ifndef SLEWLAB_TESTS_IEC_STD_LIB_H
#define SLEWLAB_TESTS_IEC_STD_LIB_H

#include <math.h>
#include <stdint.h>
#include <string.h>

typedef unsigned char BOOL;
typedef int16_t INT;
typedef int32_t DINT;
typedef int64_t LINT;
typedef float REAL;
typedef double LREAL;
typedef struct {
  long tv_sec;
  long tv_nsec;
} TIME;

extern TIME __CURRENT_TIME;

static inline int64_t nanoseconds_of(TIME time) { return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec; }

/* IEC 61131-3 Table 38: Q is true when IN has been true for PT. */
typedef struct {
  BOOL IN, Q;
  TIME PT;
  BOOL runs;
  int64_t start; /* [ns] */
} TON;

static inline void TON_init__(TON* timer) { memset(timer, 0, sizeof *timer); }

static inline void TON_body__(TON* timer) {
  const int64_t now = nanoseconds_of(__CURRENT_TIME);
  if (timer->IN && !timer->runs) timer->start = now;
  timer->runs = timer->IN;
  timer->Q = timer->IN && now - timer->start >= nanoseconds_of(timer->PT);
}

#endif
