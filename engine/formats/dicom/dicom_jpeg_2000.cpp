#include "engine/formats/dicom/dicom_jpeg_2000.h"

#include <openjpeg.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

#include "engine/base/error.h"

namespace shvr {
namespace {

/// An input stream for OpenJPEG that reads from memory instead of a file.
struct Input {
    std::span<const std::byte> bytes;
    size_t at = 0;

    static OPJ_SIZE_T read(void* buffer, OPJ_SIZE_T wanted, void* input)
    {
        Input& self = *static_cast<Input*>(input);
        const size_t count = std::min(wanted, self.bytes.size() - self.at);
        if (count == 0) return OPJ_SIZE_T(-1);  // end of the data
        std::memcpy(buffer, &self.bytes[self.at], count);
        self.at += count;
        return count;
    }
    static OPJ_OFF_T skip(OPJ_OFF_T wanted, void* input)
    {
        Input& self = *static_cast<Input*>(input);
        if (wanted < 0 || uint64_t(wanted) > self.bytes.size() - self.at) return -1;
        self.at += size_t(wanted);
        return wanted;
    }
    static OPJ_BOOL seek(OPJ_OFF_T to, void* input)
    {
        Input& self = *static_cast<Input*>(input);
        if (to < 0 || uint64_t(to) > self.bytes.size()) return OPJ_FALSE;
        self.at = size_t(to);
        return OPJ_TRUE;
    }
};

template <auto destroy>
struct Destroy {
    template <class Object>
    void operator()(Object* object) const
    {
        destroy(object);
    }
};
using Codec = std::unique_ptr<opj_codec_t, Destroy<opj_destroy_codec>>;
using Stream = std::unique_ptr<opj_stream_t, Destroy<opj_stream_destroy>>;
using Image = std::unique_ptr<opj_image_t, Destroy<opj_image_destroy>>;

/// Whether the picture is a JP2 file, by its first box (annex I.5.1), rather than a bare codestream.
bool is_in_boxes(std::span<const std::byte> picture)
{
    constexpr unsigned char SIGNATURE[] = {0, 0, 0, 12, 'j', 'P', ' ', ' ', 13, 10, 0x87, 10};
    return picture.size() > sizeof(SIGNATURE) && std::memcmp(picture.data(), SIGNATURE, sizeof(SIGNATURE)) == 0;
}

Stream stream_of(Input& input)
{
    constexpr OPJ_SIZE_T BUFFER = 65536;
    Stream stream(opj_stream_create(std::min<OPJ_SIZE_T>(BUFFER, input.bytes.size() + 1), OPJ_TRUE));
    if (!stream) throw std::bad_alloc();
    opj_stream_set_read_function(stream.get(), Input::read);
    opj_stream_set_skip_function(stream.get(), Input::skip);
    opj_stream_set_seek_function(stream.get(), Input::seek);
    opj_stream_set_user_data(stream.get(), &input, nullptr);
    opj_stream_set_user_data_length(stream.get(), input.bytes.size());
    return stream;
}

/// Checks that the picture's own header agrees with the DICOM header.
void check_header(const std::string& subject, const opj_image_t& image, int64_t columns, int64_t rows, size_t bytes)
{
    const int64_t wide = int64_t(image.x1) - image.x0, high = int64_t(image.y1) - image.y0;
    if (wide != columns || high != rows || image.numcomps != 1)
        fail(subject, ": a JPEG 2000 picture has ", wide, "x", high, " pixels of ", image.numcomps,
             " components; expected ", columns, "x", rows, " of one, as the file's header says");
    const opj_image_comp_t& grey = image.comps[0];
    if (grey.dx != 1 || grey.dy != 1)
        fail(subject, ": a JPEG 2000 picture has a value for ", grey.dx, "x", grey.dy,
             " pixels; expected one for each");
    if (grey.prec < 1 || grey.prec > 8 * bytes)
        fail(subject, ": a JPEG 2000 picture has ", grey.prec, " bits a pixel; expected 1 to ", 8 * bytes,
             ", as the file's header says");
}

template <class Number>
void take(const OPJ_INT32* values, std::span<std::byte> pixels)
{
    for (size_t i = 0; i < pixels.size() / sizeof(Number); ++i) {
        const auto number = Number(values[i]);  // sign-extended to the available bits
        std::memcpy(&pixels[i * sizeof(Number)], &number, sizeof(number));
    }
}

}  // namespace

bool is_jpeg_2000(const std::string& transfer_syntax)
{
    return transfer_syntax == "1.2.840.10008.1.2.4.90" || transfer_syntax == "1.2.840.10008.1.2.4.91";
}

void decode_jpeg_2000(const std::string& subject, std::span<const std::byte> picture, int64_t columns, int64_t rows,
                      std::span<std::byte> pixels)
{
    SHVR_CHECK(columns > 0 && rows > 0);
    const size_t bytes = pixels.size() / size_t(columns * rows);  // per pixel
    Input input{.bytes = picture};
    const Stream stream = stream_of(input);
    const Codec codec(opj_create_decompress(is_in_boxes(picture) ? OPJ_CODEC_JP2 : OPJ_CODEC_J2K));
    if (!codec) throw std::bad_alloc();
    opj_dparameters_t parameters;
    opj_set_default_decoder_parameters(&parameters);
    opj_image_t* found = nullptr;
    const bool begins = opj_setup_decoder(codec.get(), &parameters) == OPJ_TRUE &&
                        opj_read_header(stream.get(), codec.get(), &found) == OPJ_TRUE;
    const Image image(found);
    if (!begins || !image)
        fail(subject, ": the header of a JPEG 2000 picture of ", picture.size(),
             " bytes cannot be read; expected one as ITU-T T.800 defines it");
    check_header(subject, *image, columns, rows, bytes);
    if (opj_decode(codec.get(), stream.get(), image.get()) != OPJ_TRUE ||
        opj_end_decompress(codec.get(), stream.get()) != OPJ_TRUE)
        fail(subject, ": a JPEG 2000 picture of ", picture.size(),
             " bytes cannot be decoded; expected one as ITU-T T.800 defines it: it is truncated or damaged");
    check_header(subject, *image, columns, rows, bytes);  // a palette among the boxes adds components
    const opj_image_comp_t& grey = image->comps[0];
    if (grey.data == nullptr || int64_t(grey.w) != columns || int64_t(grey.h) != rows)
        fail(subject, ": a JPEG 2000 picture decodes to ", grey.w, "x", grey.h, " pixels; expected ", columns, "x",
             rows);
    switch (bytes) {
        case 1: return take<uint8_t>(grey.data, pixels);
        case 2: return take<uint16_t>(grey.data, pixels);
        default: return take<uint32_t>(grey.data, pixels);
    }
}

}  // namespace shvr
