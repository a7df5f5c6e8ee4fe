// A DICOM file of one or many frames, and the folder in which it lies; more slices may be packed.

#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.clear();
    const auto files = unpacked({data, size});
    for (const auto& [name, content] : files) folder.write("scan/" + (name.empty() ? "slice1.dcm" : name), content);
    std::filesystem::create_directories(folder.path() / "scan");
    try_volume(folder.path() / "scan");
    if (files.size() == 1) try_volume(folder.path() / "scan/slice1.dcm");
    return 0;
}
