// The `main` of every test program.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>

namespace {

/// As CMakeLists.txt sets it for tests run by ctest.
const bool environment_is_set = [] {
    setenv("VK_LAYER_ENABLES", "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT", 0);
    const std::filesystem::path layers = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "layers";
    setenv("VK_ADD_LAYER_PATH", layers.c_str(), 0);
    return true;
}();

}  // namespace
