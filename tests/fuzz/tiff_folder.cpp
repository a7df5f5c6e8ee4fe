// A folder of TIFFs, packed. A bare TIFF is two slices of it.

#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.clear();
    for (const auto& [name, content] : unpacked({data, size})) {
        folder.write("scan/" + (name.empty() ? "slice1.tif" : name), content);
        if (name.empty()) folder.write("scan/slice2.tif", content);
    }
    std::filesystem::create_directories(folder.path() / "scan");
    try_volume(folder.path() / "scan");
    return 0;
}
