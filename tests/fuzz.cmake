# Hostile files: tests/fuzz/README.md.

if(SHVR_IS_CHECKED)
    file(GLOB fuzz_sources CONFIGURE_DEPENDS tests/fuzz/*.cpp tests/fuzz/looks/*.cpp tests/fuzz/remote/*.cpp)
    set(fuzz_names ${fuzz_sources})
    list(TRANSFORM fuzz_names REPLACE ".*/([^/]*)\\.cpp" "\\1")
endif()

if(SHVR_FUZZ)
    add_custom_target(fuzz)
    foreach(source name IN ZIP_LISTS fuzz_sources fuzz_names)
        add_executable(fuzz_${name} EXCLUDE_FROM_ALL ${source})
        target_link_libraries(fuzz_${name} PRIVATE shvr_checked)
        set_target_properties(fuzz_${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
        target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
        add_dependencies(fuzz fuzz_${name})
    endforeach()
elseif(fuzz_names)
    list(JOIN fuzz_names ") TARGET(" fuzz_list)
    set(fuzz_table ${CMAKE_BINARY_DIR}/fuzz_targets.cpp)
    file(CONFIGURE OUTPUT ${fuzz_table} @ONLY CONTENT
"#include \"tests/fuzz/replay/targets.h\"
#define TARGETS TARGET(@fuzz_list@)
#define TARGET(name) extern \"C\" int shvr_fuzz_##name(const uint8_t*, size_t);
TARGETS
#undef TARGET
#define TARGET(name) shvr::fuzz::Target{#name, shvr_fuzz_##name},
std::span<const shvr::fuzz::Target> shvr::fuzz::targets()
{
    static constexpr Target ALL[] = {TARGETS};
    return ALL;
}
")
    file(GLOB replay_sources CONFIGURE_DEPENDS tests/fuzz/replay/*.cpp)
    add_executable(shvr_fuzz_replay ${replay_sources} ${fuzz_sources} ${fuzz_table})
    target_link_libraries(shvr_fuzz_replay PRIVATE shvr_checked)
    set_target_properties(shvr_fuzz_replay PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    foreach(source name IN ZIP_LISTS fuzz_sources fuzz_names)
        set_source_files_properties(${source} PROPERTIES COMPILE_DEFINITIONS LLVMFuzzerTestOneInput=shvr_fuzz_${name})
        shvr_test(fuzz ${name} 600 $<TARGET_FILE:shvr_fuzz_replay> ${name})
    endforeach()
    # The replay finds what it is for.
    foreach(pair "address=heap-buffer-overflow" "undefined=signed integer overflow" "memory=share of memory"
                 "exception=prove: exception is a finding" "time=takes too long")
        string(REGEX MATCH "([a-z]+)=(.*)" matched "${pair}")
        shvr_test(fuzz finds_${CMAKE_MATCH_1} 600 $<TARGET_FILE:shvr_fuzz_replay> --prove ${CMAKE_MATCH_1})
        set_tests_properties(fuzz/finds_${CMAKE_MATCH_1} PROPERTIES PASS_REGULAR_EXPRESSION "${CMAKE_MATCH_2}")
    endforeach()
endif()
