# Test programs, the libraries they load, and an entry of ctest for each file of tests.

# Mesa keeps the kernels that it compiled next to the objects of the compiler cache, so that a fresh clone finds both: to
# compile all kernels of the tests again takes minutes. Without a home they stay in the build folder.
set(mesa_cache ${CMAKE_BINARY_DIR}/cache)
if(DEFINED ENV{XDG_CACHE_HOME})
    set(mesa_cache $ENV{XDG_CACHE_HOME}/shvr-tests)
elseif(DEFINED ENV{HOME})
    set(mesa_cache $ENV{HOME}/.cache/shvr-tests)
endif()
file(MAKE_DIRECTORY ${mesa_cache})

set(test_environment
    LC_ALL=C PYTHONDONTWRITEBYTECODE=1
    # Caches of the program and of the driver, apart from the user's own. Tests of the program take new folders for
    # the first (tests/cli/harness.py); compiled kernels are shared by all runs.
    XDG_CACHE_HOME=${CMAKE_BINARY_DIR}/cache
    MESA_SHADER_CACHE_DIR=${mesa_cache}
    MESA_SHADER_CACHE_MAX_SIZE=512M
    # lavapipe's fast 8-bit sampling is less exact than the references allow.
    GALLIVM_PERF=no_aos_sampling
    # Hazards between submissions too, of which there is one for each tile and each frame.
    VK_LAYER_ENABLES=VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT
    VK_ADD_LAYER_PATH=${CMAKE_BINARY_DIR}/layers)

set(stability_folder ${CMAKE_BINARY_DIR}/stability)
file(MAKE_DIRECTORY ${stability_folder})

# Lines "KIND/NAME WALL CPU" in seconds, written by tools/test_times: the longest tests start first, and those that use
# more than one core count as two. A test that is not listed is as quick as most are.
set(times_file ${CMAKE_SOURCE_DIR}/tests/times.txt)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${times_file})
file(STRINGS ${times_file} times REGEX "^[a-z]+/")
foreach(line IN LISTS times)
    if(line MATCHES "^([^ ]+) ([0-9]+)[.0-9]* ([0-9]+)")
        set(wall_of_${CMAKE_MATCH_1} ${CMAKE_MATCH_2})
        set(cpu_of_${CMAKE_MATCH_1} ${CMAKE_MATCH_3})
    endif()
endforeach()
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/times)

# Registers one test and labels it `kind`; "slow" at the end of a name takes it out of the everyday run.
function(shvr_test kind name timeout)
    add_test(NAME ${kind}/${name} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
        COMMAND tests/support/timed ${CMAKE_BINARY_DIR}/times/${kind}-${name} ${ARGN})
    if(DEFINED wall_of_${kind}/${name})
        set(wall ${wall_of_${kind}/${name}})
        set_tests_properties(${kind}/${name} PROPERTIES COST ${wall})
        # As two: at least 1.3 cores in use, on average.
        math(EXPR excess "10 * ${cpu_of_${kind}/${name}} - 13 * ${wall}")
        if(wall GREATER 2 AND excess GREATER 0)
            set_tests_properties(${kind}/${name} PROPERTIES PROCESSORS 2)
        endif()
    endif()
    set(labels ${kind})
    if(name MATCHES "slow$")
        list(APPEND labels slow)
        math(EXPR timeout "10 * ${timeout}")
    endif()
    set_tests_properties(${kind}/${name} PROPERTIES LABELS "${labels}" TIMEOUT ${timeout}
        ENVIRONMENT "${test_environment}" SKIP_RETURN_CODE 77)
endfunction()

# Vulkan layers for tests of the program (tests/layers/README.md): the loader finds what stands in this folder.
set(layer_folder ${CMAKE_BINARY_DIR}/layers)
set(layers faults limits barriers speed screen clocks cache noise shuffle waits memory)
list(TRANSFORM layers PREPEND tests/layers/ OUTPUT_VARIABLE layer_sources)
list(TRANSFORM layer_sources APPEND .cpp)
add_library(shvr_layers MODULE ${layer_sources})
target_compile_features(shvr_layers PRIVATE cxx_std_20)
target_compile_options(shvr_layers PRIVATE -Wall -Wextra -Wno-missing-field-initializers)
target_link_libraries(shvr_layers PRIVATE Vulkan::Headers)
set_target_properties(shvr_layers PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${layer_folder})
set(SHVR_LAYERS_LIBRARY $<TARGET_FILE_NAME:shvr_layers>)
foreach(SHVR_LAYER IN LISTS layers)
    configure_file(tests/layers/layer.json.in ${layer_folder}/${SHVR_LAYER}.json.made @ONLY)
    file(GENERATE OUTPUT ${layer_folder}/${SHVR_LAYER}.json INPUT ${layer_folder}/${SHVR_LAYER}.json.made)
endforeach()

# Libraries in place of those that are loaded at run time (tests/stubs/README.md).
foreach(stub hd_stub hd_partial hung_disk no_locks short_memory stop_in_save)
    add_library(shvr_${stub} MODULE tests/stubs/${stub}.cpp)
    target_compile_features(shvr_${stub} PRIVATE cxx_std_20)
    target_include_directories(shvr_${stub} PRIVATE ${CMAKE_SOURCE_DIR})
    target_link_libraries(shvr_${stub} PRIVATE Threads::Threads)
    set_target_properties(shvr_${stub} PROPERTIES OUTPUT_NAME ${stub} LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/stubs)
endforeach()

shvr_library(shvr_test_support FOLDERS tests/support LINK ${shvr_modules} doctest::doctest)

# Part of a picture by the reference renderer, for benchmarks; built where one is asked for.
add_executable(shvr_reference_picture EXCLUDE_FROM_ALL tests/tools/reference_picture.cpp)
target_link_libraries(shvr_reference_picture PRIVATE shvr_test_support)
# What annotating costs:  cmake --build build/release --target bench_annotation
add_executable(shvr_annotation_bench EXCLUDE_FROM_ALL tests/tools/annotation_bench.cpp)
target_link_libraries(shvr_annotation_bench PRIVATE ${shvr_modules})
add_custom_target(bench_annotation DEPENDS shvr_annotation_bench USES_TERMINAL WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
    COMMAND shvr_annotation_bench)
# What drawing many surfaces costs:  cmake --build build/release --target bench_surfaces
add_executable(shvr_surfaces_bench EXCLUDE_FROM_ALL tests/tools/surfaces_bench.cpp)
target_link_libraries(shvr_surfaces_bench PRIVATE ${shvr_modules})
add_custom_target(bench_surfaces DEPENDS shvr_surfaces_bench USES_TERMINAL WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
    COMMAND shvr_surfaces_bench)
# Cost of an update of the workbench:  cmake --build build/release --target bench_workbench
add_executable(shvr_workbench_bench EXCLUDE_FROM_ALL tests/tools/workbench_bench.cpp)
target_link_libraries(shvr_workbench_bench PRIVATE ${shvr_modules})
add_custom_target(bench_workbench DEPENDS shvr_workbench_bench USES_TERMINAL WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
    COMMAND shvr_workbench_bench)

# One operation on groups: tools/bench/editor.py and its test run it.
add_executable(shvr_operation_bench tests/tools/operation_bench.cpp)
target_link_libraries(shvr_operation_bench PRIVATE shvr_engine)
target_compile_definitions(shvr_operation_bench PRIVATE SHVR_BUILD_TYPE="${CMAKE_BUILD_TYPE}")

# One program for all `sources` of tests/KIND, one test for each file among them.
function(shvr_test_program kind program timeout)
    set(sources ${ARGN})
    shvr_tests_together(${program} ${sources})
    add_executable(${program} ${together})
    # Where files are named *_test.cpp, the others are what they share.
    set(tests ${sources})
    list(FILTER tests INCLUDE REGEX "_test\\.cpp$")
    if(NOT tests)
        set(tests ${sources})
    endif()
    foreach(source IN LISTS tests)
        cmake_path(GET source FILENAME file)
        string(REGEX REPLACE "(_test)?\\.cpp$" "" name ${file})
        shvr_test(${kind} ${name} ${timeout}
            $<TARGET_FILE:${program}> --no-colors=true --no-skip=false --source-file=*/${file})
        # doctest is content when its filter finds nothing. A file without a test case is a mistake.
        set_tests_properties(${kind}/${name} PROPERTIES FAIL_REGULAR_EXPRESSION "test cases: *0 [|]")
        # Values measured against bounds are kept for cli/stability, which compares them with tests/STABILITY.md.
        file(STRINGS ${source} bounds REGEX "check_below\\(" LIMIT_COUNT 1)
        if(bounds)
            set_property(TEST ${kind}/${name} APPEND PROPERTY ENVIRONMENT
                SHVR_STABILITY=${stability_folder}/${kind}-${name})
            set_tests_properties(${kind}/${name} PROPERTIES FIXTURES_SETUP stability)
        endif()
    endforeach()
endfunction()

file(GLOB_RECURSE unit_tests CONFIGURE_DEPENDS tests/unit/*.cpp)
if(SHVR_IS_CHECKED)
    # Rooms of tests/checked.cmake: linked with their sanitized objects.
    set(checked_tests ${unit_tests})
    list(FILTER checked_tests INCLUDE REGEX
        "tests/unit/(annotation|base|bricks|components|formats|graph|jobs|look|movie|pieces|projects|ranks|reference|remote|session|tasks|volume)/")
    list(REMOVE_ITEM unit_tests ${checked_tests})
    file(GLOB reference_sources CONFIGURE_DEPENDS tests/reference/*.cpp)
    shvr_compile_together(shvr_checked_support ${reference_sources})
    shvr_test_program(unit shvr_checked_tests 120 ${checked_tests})
    target_sources(shvr_checked_tests PRIVATE ${together} tests/support/bounds.cpp
        tests/support/doctest_main.cpp tests/support/random_annotation.cpp)
    target_link_libraries(shvr_checked_tests PRIVATE doctest::doctest shvr_checked)
    set_target_properties(shvr_checked_tests PROPERTIES POSITION_INDEPENDENT_CODE OFF)
endif()
shvr_test_program(unit shvr_unit_tests 60 ${unit_tests})
target_link_libraries(shvr_unit_tests PRIVATE shvr_test_support)
add_dependencies(shvr_unit_tests shvr_hd_stub shvr_hd_partial)
set_tests_properties(unit/inverse3_minute_slow PROPERTIES TIMEOUT 180)

file(GLOB_RECURSE gpu_tests CONFIGURE_DEPENDS tests/gpu/*.cpp)
shvr_test_program(gpu shvr_gpu_tests 600 ${gpu_tests})
target_link_libraries(shvr_gpu_tests PRIVATE shvr_test_support)
set_tests_properties(gpu/bounds_slow PROPERTIES TIMEOUT 1800)
# Calls that wait for a disk go through tests/gpu/workbench/slow_disk.cpp.
foreach(call fsync fdatasync rename)
    target_link_options(shvr_gpu_tests PRIVATE -Wl,--wrap=${call})
endforeach()
# gpu::embedded_kernels() goes through tests/gpu/wrong_kernels.cpp.
target_link_options(shvr_gpu_tests PRIVATE -Wl,--wrap=_ZN4shvr3gpu16embedded_kernelsEv)

file(GLOB_RECURSE durability_tests CONFIGURE_DEPENDS tests/durability/*.cpp)
shvr_test_program(durability shvr_durability_tests 300 ${durability_tests})
target_link_libraries(shvr_durability_tests PRIVATE shvr_test_support)
# Calls that change files go through tests/durability/watched_calls.cpp.
set(watched_calls open write pwrite fsync fdatasync syncfs ftruncate rename renameat2 link mkdir unlink)
list(TRANSFORM watched_calls PREPEND -Wl,--wrap=)
target_link_options(shvr_durability_tests PRIVATE ${watched_calls})
# Locks that fail, and other names of this computer.
add_dependencies(shvr_durability_tests shvr_no_locks)
set_property(TEST durability/two_writers durability/interleaved_writers APPEND PROPERTY ENVIRONMENT
    LD_PRELOAD=$<TARGET_FILE:shvr_no_locks> ASAN_OPTIONS=verify_asan_link_order=0)
if(SHVR_IS_CHECKED)
    # The same under AddressSanitizer and UndefinedBehaviorSanitizer:  cmake --build build/dev --target check_durability
    shvr_tests_together(shvr_checked_durability_tests ${durability_tests})
    add_executable(shvr_checked_durability_tests EXCLUDE_FROM_ALL ${together} tests/support/doctest_main.cpp
        tests/support/random_annotation.cpp)
    target_link_libraries(shvr_checked_durability_tests PRIVATE doctest::doctest shvr_checked)
    target_link_options(shvr_checked_durability_tests PRIVATE ${watched_calls})
    set_target_properties(shvr_checked_durability_tests PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    add_custom_target(check_durability DEPENDS shvr_checked_durability_tests shvr_no_locks USES_TERMINAL
        WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
        COMMAND ${CMAKE_COMMAND} -E env LD_PRELOAD=$<TARGET_FILE:shvr_no_locks> ASAN_OPTIONS=verify_asan_link_order=0
            $<TARGET_FILE:shvr_checked_durability_tests>)
endif()

# hidapi and a real kernel, in a virtual machine: tests/vm/README.md.
add_executable(shvr_vm_test EXCLUDE_FROM_ALL tests/vm/hid_kernel.cpp tests/vm/uhid_device.cpp)
target_link_libraries(shvr_vm_test PRIVATE shvr_haptics)
shvr_test(vm hid_kernel_slow 1200 ${Python3_EXECUTABLE} tools/test_in_vm $<TARGET_FILE:shvr_vm_test>)

# tests/layers and tests/window share the harness of tests/cli.
foreach(kind cli layers window)
    file(GLOB scripts CONFIGURE_DEPENDS tests/${kind}/test_*.py tests/${kind}/*/test_*.py)
    foreach(script IN LISTS scripts)
        cmake_path(GET script STEM name)
        string(REGEX REPLACE "^test_" "" name ${name})
        shvr_test(${kind} ${name} 600
            ${CMAKE_COMMAND} -E env SHVR=$<TARGET_FILE:shvr> PYTHONPATH=${CMAKE_SOURCE_DIR}/tests/cli
            ${Python3_EXECUTABLE} ${script})
    endforeach()
endforeach()
set_tests_properties(cli/stability PROPERTIES FIXTURES_REQUIRED stability)
set_property(TEST cli/stability APPEND PROPERTY ENVIRONMENT SHVR_STABILITY_CASES=${stability_folder})

# Builds and tries the program on another release, in a root below build/ (tools/test_in_release).
shvr_test(release trixie_slow 1200 tools/test_in_release trixie)
# Builds the packages, installs, uses and purges them in a bare root; the same with the archive (tools/package).
shvr_test(release package_slow 1200 tools/package/test_installed --build)
set_tests_properties(release/trixie_slow release/package_slow PROPERTIES RUN_SERIAL ON)

shvr_test(style layers 60 ${Python3_EXECUTABLE} tools/check_layers.py)
shvr_test(style layers_self_test 60 ${Python3_EXECUTABLE} tools/check_layers.py --self-test)
shvr_test(style loops 60 ${Python3_EXECUTABLE} tools/check_loops.py)
shvr_test(style prose 60 ${Python3_EXECUTABLE} tools/check_prose.py)
shvr_test(style changed_tests 60 ${Python3_EXECUTABLE} tools/changed_tests --self-test)
shvr_test(style format 60 tools/check_format)
shvr_test(style shell 60 tools/check_shell)
shvr_test(style kinds 60 tools/make_kinds_table --check)
