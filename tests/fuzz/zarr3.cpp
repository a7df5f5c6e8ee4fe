// A hierarchy of Zarr version 3, packed. A bare input is the zarr.json of an array or a group.

#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.clear();
    for (const auto& [name, content] : unpacked({data, size})) {
        folder.write("scan.zarr/" + (name.empty() ? "zarr.json" : name), content);
    }
    std::filesystem::create_directories(folder.path() / "scan.zarr");
    try_volume(folder.path() / "scan.zarr");
    return 0;
}
