// MetaImage: one header, with files beside it that it may name.

#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.fill({data, size}, "scan.mhd");
    for (const char* name : {"a.voxels", "slice01.voxels", "slice02.voxels", "slice03.voxels"}) {
        if (!std::filesystem::exists(folder.path() / name)) folder.write(name, std::string(120, 'v'));
    }
    try_volume(folder.path() / "scan.mhd");
    return 0;
}
