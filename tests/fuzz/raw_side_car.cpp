// Side-car files of bare voxels: our JSON, the text or XML of scanners, or the headers of CT scanners.

#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    const std::string_view text = text_of({data, size});
    const char* const name = text.starts_with("{volume")   ? "scan.vgi"
                             : text.starts_with("[XTekCT") ? "scan.xtekct"
                             : text.starts_with("! PyHST") ? "scan.raw.info"
                             : text.starts_with("{")       ? "scan.json"
                                                           : "scan.dat";
    folder.fill({data, size}, name);
    if (!std::filesystem::exists(folder.path() / "scan.raw")) folder.write("scan.raw", std::string(124, 'v'));
    try_volume(folder.path() / "scan.raw");
    try_volume(folder.path() / name);
    return 0;
}
