# Add a test that runs tarl-lint on the package.
#
# ament_tarl_lint([TESTNAME name] [path or option of tarl-lint ...])
#
# TESTNAME is tarl_lint by default. Without paths, the whole package is linted.
function(ament_tarl_lint)
  cmake_parse_arguments(ARG "" "TESTNAME" "" ${ARGN})
  if(NOT ARG_TESTNAME)
    set(ARG_TESTNAME "tarl_lint")
  endif()
  find_program(ament_tarl_lint_BIN NAMES "ament_tarl_lint")
  if(NOT ament_tarl_lint_BIN)
    message(FATAL_ERROR "ament_tarl_lint is not on the PATH: build the package ament_tarl_lint and source its setup file.")
  endif()
  set(_result "${AMENT_TEST_RESULTS_DIR}/${PROJECT_NAME}/${ARG_TESTNAME}.xunit.xml")
  ament_add_test(
    "${ARG_TESTNAME}"
    COMMAND "${ament_tarl_lint_BIN}" "--xunit-file" "${_result}" ${ARG_UNPARSED_ARGUMENTS}
    OUTPUT_FILE "${CMAKE_BINARY_DIR}/ament_tarl_lint/${ARG_TESTNAME}.txt"
    RESULT_FILE "${_result}"
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}")
  set_tests_properties("${ARG_TESTNAME}" PROPERTIES LABELS "tarl_lint;linter")
endfunction()
