// A folder of slices as TIFF, PNG, BMP or JPEG, packed, with logs next to them. A bare file is two slices of it; a bare
// picture is a volume by itself, too.

#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

namespace {

std::string extension_of(const std::string& content)
{
    return content.starts_with("\xff\xd8")  ? ".jpg"
           : content.starts_with("BM")      ? ".bmp"
           : content.starts_with("\x89PNG") ? ".png"
                                            : ".tif";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.clear();
    for (const auto& [name, content] : unpacked({data, size})) {
        if (!name.empty()) {
            folder.write("scan/" + name, content);
            continue;
        }
        const std::string extension = extension_of(content);
        folder.write("scan/slice2" + extension, content);
        const std::filesystem::path first = folder.write("scan/slice1" + extension, content);
        if (extension != ".tif") try_volume(first);
    }
    std::filesystem::create_directories(folder.path() / "scan");
    try_volume(folder.path() / "scan");
    return 0;
}
