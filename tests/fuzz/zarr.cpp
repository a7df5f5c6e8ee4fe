// A Zarr array or OME-Zarr image, packed, or a project with its shvr/ folder. A bare input is the .zarray of a flat
// array.

#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.clear();
    for (const auto& [name, content] : unpacked({data, size})) {
        folder.write("scan.zarr/" + (name.empty() ? ".zarray" : name), content);
    }
    std::filesystem::create_directories(folder.path() / "scan.zarr");
    try_volume(folder.path() / "scan.zarr");
    return 0;
}
