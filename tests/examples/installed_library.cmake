# cmake -DBUILD=build/release -DSOURCE=. -DCOMPILER=c++ -DFLAGS= -P installed_library.cmake    (FLAGS: of the libraries, as of a sanitizer)
#
# Installs the libraries into a folder of its own, moves that folder, builds examples/library against it as a stranger would,
# runs it, and looks for the source folder's name in what was built and installed.
set(place ${BUILD}/installed_library)
file(REMOVE_RECURSE ${place})
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

run(${CMAKE_COMMAND} --install ${BUILD} --component development --prefix ${place}/first)
file(RENAME ${place}/first ${place}/prefix)
file(COPY ${SOURCE}/examples/library DESTINATION ${place})
run(${CMAKE_COMMAND} -S ${place}/library -B ${place}/build -DCMAKE_PREFIX_PATH=${place}/prefix -DCMAKE_CXX_COMPILER=${COMPILER}
    -DSUNDIALS_DIR=${SUNDIALS_DIR} -DCMAKE_CXX_FLAGS=${FLAGS})
run(${CMAKE_COMMAND} --build ${place}/build)
run(${place}/build/stop_study ${SOURCE}/config/scenarios/thesis_slew.yaml)

# 1.31 Hz: thesis 4.1. 2.19 m/s^2 after the emergency stop: what `slewlab run` reports of the same scenario (README.md).
foreach(expected "boom's first bending mode: 1.31 Hz" "tip acceleration up to 2.19 m/s")
  string(FIND "${said}" "${expected}" found)
  if(found LESS 0)
    message(FATAL_ERROR "no '${expected}' in:\n${said}")
  endif()
endforeach()

file(GLOB_RECURSE installed ${place}/prefix/*)
list(APPEND installed ${place}/build/stop_study)
if(FLAGS MATCHES "-fsanitize")  # whose reports name source files
  set(installed)
endif()
foreach(file IN LISTS installed)
  file(STRINGS ${file} lines REGEX "${SOURCE}/(common|msgs|controller|sim|diagnosis|tools|build)")
  if(lines)
    message(FATAL_ERROR "${file} holds the source folder: ${lines}")
  endif()
endforeach()
file(REMOVE_RECURSE ${place})
