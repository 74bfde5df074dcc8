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
foreach(file share/man/man1/slewlab.1 share/man/man1/slewlab-run.1 share/bash-completion/completions/slewlab share/doc/slewlab/LICENSE)
  if(NOT EXISTS ${place}/root/usr/${file})
    message(FATAL_ERROR "the package has no ${file}")
  endif()
endforeach()
file(REMOVE_RECURSE ${place})
