// The `main` of every test program.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "tests/support/at_end.h"

namespace {

/// Sets the environment as CMakeLists.txt does for tests run by ctest.
const bool environment_is_set = [] {
    setenv("VK_LAYER_ENABLES", "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT", 0);
    const std::filesystem::path layers = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "layers";
    setenv("VK_ADD_LAYER_PATH", layers.c_str(), 0);
    return true;
}();

std::vector<std::function<void()>>& acts()
{
    static std::vector<std::function<void()>> all;
    return all;
}

}  // namespace

void shvr::test::at_end(std::function<void()> act)
{
    acts().push_back(std::move(act));
}

int main(int count, char** arguments)
{
    const int status = doctest::Context(count, arguments).run();
    for (; !acts().empty(); acts().pop_back()) acts().back()();
    return status;
}
