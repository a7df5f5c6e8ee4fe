// One TIFF file.

#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.clear();
    try_volume(folder.write("scan.tif", text_of({data, size})));
    return 0;
}
