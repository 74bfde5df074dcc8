# What `cmake --install` gives to programs of others: the libraries of the rooms, their headers, and find_package(slewlab).
# Components: programs, development, python (tools/python).
include(CMakePackageConfigHelpers)

add_library(slewlab_libraries INTERFACE)
target_link_libraries(slewlab_libraries INTERFACE slewlab_diagnosis slewlab_loop slewlab_sim_analysis slewlab_sim_drive
                                                  slewlab_sim_reference)
target_compile_features(slewlab_libraries INTERFACE cxx_std_20)
set_target_properties(slewlab_libraries PROPERTIES EXPORT_NAME slewlab)
install(TARGETS slewlab_libraries EXPORT slewlab COMPONENT development)

set(package_dir lib/cmake/slewlab)
install(EXPORT slewlab NAMESPACE slewlab:: FILE slewlabTargets.cmake DESTINATION ${package_dir} COMPONENT development)
configure_package_config_file(${CMAKE_SOURCE_DIR}/cmake/slewlabConfig.cmake.in ${CMAKE_BINARY_DIR}/slewlabConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/slewlabConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/slewlabConfig.cmake ${CMAKE_BINARY_DIR}/slewlabConfigVersion.cmake
              ${CMAKE_SOURCE_DIR}/cmake/FindLCM.cmake
        DESTINATION ${package_dir} COMPONENT development)
foreach(room common msgs controller sim diagnosis)
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/${room} DESTINATION include/slewlab COMPONENT development FILES_MATCHING PATTERN "*.h")
endforeach()
install(DIRECTORY ${CMAKE_BINARY_DIR}/generated/slewlab_msgs DESTINATION include/slewlab COMPONENT development
        FILES_MATCHING PATTERN "*.hpp")
install(FILES ${CMAKE_SOURCE_DIR}/LICENSE DESTINATION share/doc/slewlab COMPONENT programs)

# A Debian package: cpack --config build/release/CPackConfig.cmake -B OUT. Programs, config, manual pages, completion, and the
# Python side, for which Debian has in part what it needs: its plotly is too old (docs/install.md).
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME slewlab)
set(CPACK_PACKAGE_VENDOR "The slewlab authors")
set(CPACK_PACKAGE_CONTACT "The slewlab authors <slewlab@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulated crane slewing drive with controllers in its loop")
set(CPACK_PACKAGE_DESCRIPTION "Simulates the slewing drive of an offshore pedestal crane, runs controllers against it over LCM in lockstep, and tells which effect a measured machine has that its model has not.")
set(CPACK_RESOURCE_FILE_LICENSE ${CMAKE_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_CMAKE_PROJECTS "${CMAKE_BINARY_DIR};slewlab;programs;/")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3, python3-venv, python3-numpy, python3-pandas, iproute2, util-linux")
include(CPack)
