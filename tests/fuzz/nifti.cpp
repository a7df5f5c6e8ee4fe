// NIfTI: scan.nii, deflated or not; or a header with a packed scan.img or scan.img.gz.

#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    const std::string_view text = text_of({data, size});
    const bool is_pair = text.find("\n@@FILE scan.img") != std::string_view::npos;
    const std::string name =
        std::string(is_pair ? "scan.hdr" : "scan.nii") + (text.starts_with("\x1f\x8b") ? ".gz" : "");
    folder.fill({data, size}, name);
    try_volume(folder.path() / name);
    return 0;
}
