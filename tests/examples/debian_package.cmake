# cmake -DBUILD=build/release -DSOURCE=. -P debian_package.cmake
#
# Makes the Debian package, unpacks it elsewhere and uses what is in it.
set(place ${BUILD}/debian_package)
file(REMOVE_RECURSE ${place})
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

run(${CPACK} --config ${BUILD}/CPackConfig.cmake -B ${place})
file(GLOB package ${place}/slewlab_*.deb)
run(dpkg-deb --extract ${package} ${place}/root)
set(program ${place}/root/usr/bin/slewlab)
run(${program} --version)
string(FIND "${said}" "slewlab ${VERSION}\n" found)
if(found LESS 0)
  message(FATAL_ERROR "no version ${VERSION} in: ${said}")
endif()
# What it finds without being told: its own templates and config.
run(${program} new crane ${place}/crane.yaml)
run(${program} check ${place}/crane.yaml)
run(${SOURCE}/tools/in-private-network ${program} run ${place}/root/usr/share/slewlab/config/scenarios/thesis_slew.yaml
    --set duration=2 --out ${place}/run --progress none)
foreach(file share/man/man1/slewlab.1 share/man/man1/slewlab-run.1 share/man/man1/slewlab-plant.1 share/man/man1/slewlab-controller.1
             share/man/man1/slewlab-st-host.1 share/slewlab/tools/python/requirements.txt share/bash-completion/completions/slewlab share/doc/slewlab/LICENSE)
  if(NOT EXISTS ${place}/root/usr/${file})
    message(FATAL_ERROR "the package has no ${file}")
  endif()
endforeach()

# The Dockerfile's steps, where no builder is: what it copies and builds is there, and its default does the demo from the
# package alone, with the Python libraries where the image has them.
file(READ ${SOURCE}/Dockerfile dockerfile)
run(${CMAKE_COMMAND} --build ${BUILD} --target help)
string(REGEX MATCH "tools/build ([a-z_ -]+)" targets "${dockerfile}")
string(REPLACE " " ";" targets "${CMAKE_MATCH_1}")
foreach(target IN LISTS targets)
  if(target AND NOT said MATCHES "(^|\n)${target}: ")
    message(FATAL_ERROR "Dockerfile: there is no target '${target}'")
  endif()
endforeach()
string(REGEX MATCHALL "/source/[A-Za-z0-9_./-]+" copied "${dockerfile}")
foreach(file IN LISTS copied)
  string(REPLACE "/source/" "${SOURCE}/" file ${file})
  if(NOT EXISTS ${file})
    message(FATAL_ERROR "Dockerfile: there is no ${file}")
  endif()
endforeach()
# Without its libraries a command says what installs them, of files that the package has.
execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=PYTHONPATH SLEWLAB_PYTHON=/usr/bin/python3 ${program} report ${place}/run RESULT_VARIABLE code ERROR_VARIABLE said OUTPUT_QUIET)
if(NOT code EQUAL 0 AND NOT said MATCHES "slewlab report: the Python library .*pip install -r ${place}/root/usr/share/slewlab/tools/python/requirements.txt; or .* SLEWLAB_PYTHON")
  message(FATAL_ERROR "of a library that is not installed it says: ${said}")
endif()
file(CREATE_LINK ${SOURCE}/.venv ${place}/root/usr/share/slewlab/.venv SYMBOLIC)
string(REGEX MATCH "CMD (\\[.*\\])" default "${dockerfile}")
string(JSON script GET "${CMAKE_MATCH_1}" 2)
string(REPLACE "/usr/share/" "${place}/root/usr/share/" script "${script}")
file(WRITE ${place}/default.sh "${script}\n")
file(MAKE_DIRECTORY ${place}/runs)
run(${CMAKE_COMMAND} -E chdir ${place}/runs ${CMAKE_COMMAND} -E env PATH=${place}/root/usr/bin:$ENV{PATH}
    ${SOURCE}/tools/in-private-network /bin/sh ${place}/default.sh)
if(NOT EXISTS ${place}/runs/play_compensation.html)
  message(FATAL_ERROR "Dockerfile: its default made no page: ${said}")
endif()
file(REMOVE_RECURSE ${place})
