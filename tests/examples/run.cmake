# run(COMMAND...): ends the script where the command fails; what it said is in `said`.
function(run)
  execute_process(COMMAND ${ARGV} OUTPUT_VARIABLE said ERROR_VARIABLE said RESULT_VARIABLE code)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGV}: ${code}\n${said}")
  endif()
  set(said "${said}" PARENT_SCOPE)
endfunction()
