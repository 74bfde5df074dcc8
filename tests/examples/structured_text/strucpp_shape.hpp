// The translated example (translate.py) in the shape of what STruC++ generates: a program class, a table of its located variables, and the
// clock that its timers read. The names are STruC++'s, the code is ours.
#pragma once

#include <cstdint>

extern "C" {
#include "iec_std_lib.h"
extern unsigned long long common_ticktime__;
void config_init__(void);
void config_run__(unsigned long tick);
}

namespace strucpp {

inline std::int64_t __CURRENT_TIME_NS = 0;

enum class LocatedArea : std::uint8_t { Input, Output, Memory };
enum class LocatedSize : std::uint8_t { Bit, Byte, Word, DWord, LWord };

struct LocatedVar {
  LocatedArea area;
  LocatedSize size;
  std::uint16_t byte_index;
  std::uint8_t bit_index;
  std::uint8_t _reserved[3];
  void* pointer;
};

extern LocatedVar locatedVars[];
extern const std::uint32_t locatedVarsCount;

class ProgramBase {
 public:
  virtual ~ProgramBase() = default;
  virtual void run() = 0;
};

class Program_SLEWING : public ProgramBase {
 public:
  Program_SLEWING();
  void run() override;
};

}  // namespace strucpp
