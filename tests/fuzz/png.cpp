// Input pictures of a comparison.

#include "engine/base/image_file.h"
#include "tests/fuzz/support/attempt.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    Image8 image;
    if (!accepts([&] { image = decode_png(std::as_bytes(std::span(data, size)), "picture"); })) return 0;
    const std::vector<std::byte> file = encode_png(image, "picture");
    const Image8 again = decode_png(file, "picture");
    expect(again == image, "a picture that changes when it is written");
    return 0;
}
