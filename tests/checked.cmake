# Rooms without a device, compiled once more under AddressSanitizer and UndefinedBehaviorSanitizer. What reads files from
# strangers replays the seeds of tests/fuzz with them, and the unit tests of these rooms run with them, every day. Builds
# with sanitizers and builds for people run those tests with the engine that they compile anyway.
set(SHVR_IS_CHECKED OFF)
if(SHVR_SANITIZE STREQUAL "" AND NOT CMAKE_BUILD_TYPE STREQUAL "Release")
    set(SHVR_IS_CHECKED ON)
    set(checked_sources)
    foreach(room base pieces ranks volume remote graph look components bricks formats projects annotation session jobs tasks movie)
        file(GLOB_RECURSE sources CONFIGURE_DEPENDS engine/${room}/*.cpp)
        list(FILTER sources EXCLUDE REGEX "engine/ranks/(alone|mpi)/")  # the build decides on one of them
        list(APPEND checked_sources ${sources})
    endforeach()
    file(GLOB sources CONFIGURE_DEPENDS haptics/[!s]*.cpp haptics/sa*.cpp haptics/si*.cpp haptics/replay/*.cpp
        haptics/hid/hid_pro*.cpp haptics/hid/hid_recording.cpp
        haptics/inverse3/*_frame.cpp haptics/inverse3/*_message.cpp tests/fuzz/support/*.cpp)
    list(APPEND checked_sources ${sources})
    # "undefined" leaves float-cast-overflow out, and numbers of headers become integers in many places.
    set(checks -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all)
    if(SHVR_FUZZ)
        list(APPEND checks -fsanitize=fuzzer-no-link)  # coverage is reported, without the fuzzer's main
    endif()
    add_library(shvr_checks INTERFACE)
    target_compile_options(shvr_checks INTERFACE ${checks} -O1 -g1 -U_FORTIFY_SOURCE -fno-omit-frame-pointer -Wno-error)
    # At a fixed address: the loader would write two million addresses of the sanitizers' tables, a third of a start.
    target_compile_options(shvr_checks INTERFACE -fno-pie)
    target_link_options(shvr_checks INTERFACE ${checks})
    shvr_compile_together(shvr_checked ${checked_sources})
    add_library(shvr_checked STATIC EXCLUDE_FROM_ALL ${together} ${kernel_table})
    target_link_libraries(shvr_checked PUBLIC shvr_options nlohmann_json::nlohmann_json PNG::PNG TIFF::TIFF JPEG::JPEG
        pugixml::pugixml PkgConfig::BLOSC PkgConfig::ZSTD PkgConfig::XXHASH ZLIB::ZLIB gdcm PkgConfig::OPENJPEG PkgConfig::CURL Threads::Threads glm::glm
        shvr_checks)  # last: its options come after the others
    set_target_properties(shvr_checked PROPERTIES POSITION_INDEPENDENT_CODE OFF)
endif()
