#include "engine/formats/dicom/dicom_jpeg_2000.h"

#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

#include <doctest/doctest.h>
#include <openjpeg.h>

#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Bytes = std::vector<std::byte>;

struct Form {
    unsigned wide = 70, high = 50;
    int bits = 16;
    bool is_signed = false;
    bool has_boxes = false;
    unsigned components = 1;
    unsigned apart = 1;  ///< pixels for each value
    int tile = 0;        ///< pixels; 0: one for all
};

/// A picture of `values`, without loss.
Bytes encoded(const Form& form, const std::vector<int>& values)
{
    std::vector<opj_image_cmptparm_t> components(form.components);
    for (opj_image_cmptparm_t& component : components) {
        component = {};
        component.dx = component.dy = form.apart;
        component.w = form.wide;
        component.h = form.high;
        component.prec = OPJ_UINT32(form.bits);
        component.sgnd = form.is_signed;
    }
    opj_image_t* const image = opj_image_create(form.components, components.data(), OPJ_CLRSPC_GRAY);
    REQUIRE(image != nullptr);
    image->x1 = (form.wide - 1) * form.apart + 1;
    image->y1 = (form.high - 1) * form.apart + 1;
    for (unsigned i = 0; i < form.components; ++i) std::copy(values.begin(), values.end(), image->comps[i].data);

    opj_cparameters_t parameters;
    opj_set_default_encoder_parameters(&parameters);
    parameters.tcp_numlayers = 1;
    parameters.cp_disto_alloc = 1;
    parameters.numresolution = std::min(form.wide, form.high) < 16 ? 1 : 3;
    if (form.tile > 0) {
        parameters.tile_size_on = OPJ_TRUE;
        parameters.cp_tdx = parameters.cp_tdy = form.tile;
    }
    struct Output {
        Bytes bytes{};
        size_t at = 0;
    } output;
    opj_stream_t* const stream = opj_stream_create(65536, OPJ_FALSE);
    opj_stream_set_user_data(stream, &output, nullptr);
    opj_stream_set_write_function(stream, [](void* from, OPJ_SIZE_T count, void* to) -> OPJ_SIZE_T {
        Output& self = *static_cast<Output*>(to);
        self.bytes.resize(std::max(self.bytes.size(), self.at + count));
        std::memcpy(&self.bytes[self.at], from, count);
        self.at += count;
        return count;
    });
    opj_stream_set_skip_function(stream, [](OPJ_OFF_T count, void* to) -> OPJ_OFF_T {
        static_cast<Output*>(to)->at += size_t(count);
        return count;
    });
    opj_stream_set_seek_function(stream, [](OPJ_OFF_T at, void* to) -> OPJ_BOOL {
        static_cast<Output*>(to)->at = size_t(at);
        return OPJ_TRUE;
    });
    opj_codec_t* const codec = opj_create_compress(form.has_boxes ? OPJ_CODEC_JP2 : OPJ_CODEC_J2K);
    REQUIRE(opj_setup_encoder(codec, &parameters, image) == OPJ_TRUE);
    REQUIRE(opj_start_compress(codec, image, stream) == OPJ_TRUE);
    REQUIRE(opj_encode(codec, stream) == OPJ_TRUE);
    REQUIRE(opj_end_compress(codec, stream) == OPJ_TRUE);
    opj_destroy_codec(codec);
    opj_stream_destroy(stream);
    opj_image_destroy(image);
    return output.bytes;
}

std::vector<int> values_for(const Form& form)
{
    std::mt19937 random(7);
    const int64_t count = int64_t{1} << form.bits, least = form.is_signed ? -count / 2 : 0;
    std::vector<int> values(size_t(form.wide) * form.high);
    for (int& value : values) value = int(least + int64_t(random()) % count);
    return values;
}

template <class Number>
std::vector<int> decoded(const Form& form, const Bytes& picture)
{
    Bytes pixels(size_t(form.wide) * form.high * sizeof(Number));
    decode_jpeg_2000("a", picture, form.wide, form.high, pixels);
    std::vector<int> values;
    for (size_t i = 0; i < pixels.size(); i += sizeof(Number)) {
        Number number;
        std::memcpy(&number, &pixels[i], sizeof(number));
        values.push_back(int(number));
    }
    return values;
}

std::string refusal(const Bytes& picture, int64_t columns = 70, int64_t rows = 50, size_t pixel_bytes = 2)
{
    Bytes pixels(size_t(columns * rows) * pixel_bytes);
    return error_of([&] { decode_jpeg_2000("a", picture, columns, rows, pixels); });
}

/// The precision and sign of the only component, in the picture's SIZ segment (T.800, A.5.1).
std::byte& precision(Bytes& picture)
{
    return picture.at(42);
}

}  // namespace

TEST_CASE("JPEG 2000 pictures of any depth, in boxes or not, in tiles or not, hold the values that were written")
{
    for (const Form& form : {Form{}, Form{.has_boxes = true}, Form{.tile = 32}, Form{.wide = 5, .high = 4},
                             Form{.wide = 1, .high = 1}, Form{.bits = 12}, Form{.bits = 8}, Form{.bits = 1}}) {
        CAPTURE(form.bits);
        const std::vector<int> values = values_for(form);
        const Bytes picture = encoded(form, values);
        CHECK(decoded<uint16_t>(form, picture) == values);  // more bits than there are, too
        if (form.bits <= 8) CHECK(decoded<uint8_t>(form, picture) == values);
        CHECK(decoded<int32_t>(form, picture) == values);
    }
    for (const int bits : {8, 12, 16}) {
        const Form form{.bits = bits, .is_signed = true};
        const std::vector<int> values = values_for(form);
        CHECK(decoded<int16_t>(form, encoded(form, values)) == values);
    }
}

TEST_CASE("JPEG 2000 pictures that are not what the file's header says are refused")
{
    const Form form;
    const std::vector<int> values = values_for(form);
    Bytes good = encoded(form, values);
    CHECK(refusal(good) == "");
    CHECK(
        contains(refusal(good, 50, 70), "a: a JPEG 2000 picture has 70x50 pixels of 1 components; expected 50x70 of"));
    CHECK(contains(refusal(good, 70, 50, 1), "has 16 bits a pixel; expected 1 to 8"));
    CHECK(contains(refusal(encoded({.components = 2}, values)), "70x50 pixels of 2 components; expected 70x50 of one"));
    const Form apart{.apart = 2};
    CHECK(contains(refusal(encoded(apart, values), 139, 99), "a value for 2x2 pixels; expected one for each"));
    // GDCM's decoder writes 24 bits into 16.
    Bytes deep = good;
    precision(deep) = std::byte{24 - 1};
    CHECK(contains(refusal(deep), "has 24 bits a pixel; expected 1 to 16, as the file's header says"));
}

TEST_CASE("damaged JPEG 2000 pictures are refused in words, or decoded")
{
    const Form form{.wide = 20, .high = 12};
    const std::vector<int> values = values_for(form);
    for (const bool has_boxes : {false, true}) {
        Form boxed = form;
        boxed.has_boxes = has_boxes;
        const Bytes good = encoded(boxed, values);
        CHECK(refusal({}, 20, 12) != "");
        for (size_t length = 0; length + 2 < good.size(); length += 1 + length / 16) {
            const Bytes cut(good.begin(), good.begin() + std::ptrdiff_t(length));
            CHECK(contains(refusal(cut, 20, 12), "a JPEG 2000 picture"));
        }
        for (size_t at = 0; at < std::min<size_t>(good.size(), 220); ++at) {
            for (const int bits : {0x01, 0x80, 0xff}) {
                Bytes bad = good;
                bad[at] ^= std::byte(bits);
                const std::string said = refusal(bad, 20, 12);
                CHECK((said.empty() || contains(said, "a JPEG 2000 picture")));
            }
        }
    }
    // GDCM follows the length of a segment of the header (here FF52, its coding style) beyond the picture's end.
    Bytes bad = encoded(form, values);
    const std::byte marker[] = {std::byte{0xff}, std::byte{0x52}};
    const auto found = std::ranges::search(bad, marker);
    REQUIRE(found.begin() != bad.end());
    found.begin()[2] = std::byte{0x90};
    CHECK(contains(refusal(bad, 20, 12), "the header of a JPEG 2000 picture of"));
}
