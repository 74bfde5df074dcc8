# LCM::LCM, the library alone: Debian's lcm.pc asks for glib's development files, which only LCM itself needs,
# and 1.3.1 has no CMake package. LCM_GEN is the program that makes C++ out of .lcm files.
# Where a wheel is built, PyPI's lcm is at hand too (tools/python/CMakeLists.txt), in a folder that goes when the wheel is done.
set(lcm_of_the_system)
if(SKBUILD)
  set(lcm_of_the_system NO_CMAKE_PATH)
endif()
find_path(LCM_INCLUDE_DIR lcm/lcm.h ${lcm_of_the_system})
find_library(LCM_LIBRARY lcm ${lcm_of_the_system})
find_program(LCM_GEN lcm-gen HINTS ${LCM_INCLUDE_DIR}/../bin ${lcm_of_the_system})

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LCM REQUIRED_VARS LCM_LIBRARY LCM_INCLUDE_DIR LCM_GEN)

if(LCM_FOUND AND NOT TARGET LCM::LCM)
  add_library(LCM::LCM UNKNOWN IMPORTED)
  set_target_properties(LCM::LCM PROPERTIES IMPORTED_LOCATION ${LCM_LIBRARY}
                                            INTERFACE_INCLUDE_DIRECTORIES ${LCM_INCLUDE_DIR})
endif()
mark_as_advanced(LCM_INCLUDE_DIR LCM_LIBRARY LCM_GEN)
