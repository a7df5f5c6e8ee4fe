// Side-car files of bare voxels: our JSON, or the text or XML of scanners.

#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    const bool is_json = text_of({data, size}).starts_with("{");
    const char* const name = is_json ? "scan.json" : "scan.dat";
    folder.fill({data, size}, name);
    if (!std::filesystem::exists(folder.path() / "scan.raw")) folder.write("scan.raw", std::string(124, 'v'));
    try_volume(folder.path() / "scan.raw");
    try_volume(folder.path() / name);
    return 0;
}
