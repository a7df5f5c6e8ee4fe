# Writes OUTPUT, a C++ source with the commit of the sources in SOURCE; leaves an up-to-date file unchanged.
#
#   cmake -DSOURCE=... -DOUTPUT=... -P tools/package/write_commit.cmake
#
# For sources without git history, the environment variable SHVR_COMMIT names the commit.

set(commit "$ENV{SHVR_COMMIT}")
if(commit STREQUAL "")
    execute_process(COMMAND git -C ${SOURCE} rev-parse --short=12 HEAD OUTPUT_VARIABLE commit ERROR_QUIET
        OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
if(NOT commit MATCHES "^[0-9a-f]*$")
    set(commit "")
endif()
set(text "namespace shvr::cli {\nconst char* built_commit();\nconst char* built_commit()\n{\n    return \"${commit}\";\n}\n}  // namespace shvr::cli\n")
if(EXISTS ${OUTPUT})
    file(READ ${OUTPUT} old)
endif()
if(NOT old STREQUAL text)
    file(WRITE ${OUTPUT} "${text}")
endif()
