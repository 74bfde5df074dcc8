#include "strucpp_shape.hpp"

#define __LOCATED_VAR(type, name, ...) \
  static type memory_of##name;         \
  extern "C" {                         \
  type* name = &memory_of##name;       \
  }
#include "LOCATED_VARIABLES.h"
#undef __LOCATED_VAR

extern "C" {
TIME __CURRENT_TIME;
}

namespace strucpp {
namespace {

constexpr LocatedArea area_of(const char* letter) { return *letter == 'I' ? LocatedArea::Input : LocatedArea::Output; }
constexpr LocatedSize size_of(const char* letter) { return *letter == 'X' ? LocatedSize::Bit : LocatedSize::LWord; }

}  // namespace

// __LOCATED_VAR(LREAL,__IL8,I,L,8), __LOCATED_VAR(BOOL,__IX2000_0,I,X,2000,0)
#define FIRST_OF(first, ...) first
#define SECOND_OF(first, second, ...) second
#define __LOCATED_VAR(type, name, area, size, ...) \
  {area_of(#area), size_of(#size), FIRST_OF(__VA_ARGS__, 0), SECOND_OF(__VA_ARGS__, 0, 0), {0, 0, 0}, &memory_of##name},
LocatedVar locatedVars[] = {
#include "LOCATED_VARIABLES.h"
};
#undef __LOCATED_VAR
const std::uint32_t locatedVarsCount = sizeof locatedVars / sizeof locatedVars[0];

Program_SLEWING::Program_SLEWING() {
#define __LOCATED_VAR(type, name, ...) memory_of##name = type{};
#include "LOCATED_VARIABLES.h"
#undef __LOCATED_VAR
  config_init__();
}

void Program_SLEWING::run() {
  constexpr std::int64_t kSecond = 1'000'000'000;
  __CURRENT_TIME.tv_sec = static_cast<long>(__CURRENT_TIME_NS / kSecond);
  __CURRENT_TIME.tv_nsec = static_cast<long>(__CURRENT_TIME_NS % kSecond);
  config_run__(0);
}

}  // namespace strucpp
