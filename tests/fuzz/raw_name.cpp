// The name of a file of bare voxels, which may give their size and type, and the layout argument of --raw.

#include <algorithm>

#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    std::string text(text_of({data, std::min(size, size_t{200})}));
    if (text.ends_with('\n')) text.pop_back();
    const InputFolder& folder = input_folder();
    folder.clear();
    const bool is_layout = text.find(':') != std::string::npos;
    if (is_layout) {
        const auto voxels = folder.write("bare", std::string(120, 'v'));
        std::unique_ptr<VolumeSource> source;
        if (accepts([&] { source = open_raw(voxels, parse_raw_layout(text)); })) try_source(*source);
        return 0;
    }
    std::replace_if(
        text.begin(), text.end(), [](char letter) { return letter <= ' ' || letter >= 127 || letter == '/'; }, '_');
    if (text.empty() || text == "." || text == "..") text = "empty";
    try_volume(folder.write(text, std::string(120, 'v')));
    return 0;
}
