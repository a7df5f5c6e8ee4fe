#include <gdcmFragment.h>
#include <gdcmJPEGCodec.h>
#include <gdcmJPEGLSCodec.h>
#include <gdcmRLECodec.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTransferSyntax.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/dicom/dicom_file.h"
#include "engine/formats/dicom/dicom_jpeg_2000.h"
#include "engine/formats/dicom/gdcm_turn.h"

namespace shvr {
namespace {

/// Converts big-endian numbers to the machine's byte order.
void turn_bytes(std::span<std::byte> pixels, size_t bytes_of_number)
{
    for (size_t i = 0; i + bytes_of_number <= pixels.size(); i += bytes_of_number)
        std::reverse(pixels.begin() + std::ptrdiff_t(i), pixels.begin() + std::ptrdiff_t(i + bytes_of_number));
}

/// Extracts the `stored.bits` bits of each number, the highest of which is bit `stored.high_bit`, and drops the other
/// bits, which may hold overlays.
template <class Number>
void take_bits(const DicomStored& stored, std::span<std::byte> pixels)
{
    constexpr int ALL = 8 * int(sizeof(Number));
    if (stored.bits == ALL) return;
    for (size_t i = 0; i + sizeof(Number) <= pixels.size(); i += sizeof(Number)) {
        std::make_unsigned_t<Number> number;
        std::memcpy(&number, &pixels[i], sizeof(number));
        const auto upwards = std::make_unsigned_t<Number>(number << (ALL - 1 - stored.high_bit));
        const auto value = Number(Number(upwards) >> (ALL - stored.bits));  // sign-extended, if signed
        std::memcpy(&pixels[i], &value, sizeof(value));
    }
}

void take_bits(const DicomFile& file, std::span<std::byte> pixels)
{
    switch (file.type) {
        case VoxelType::int8: return take_bits<int8_t>(file.stored, pixels);
        case VoxelType::uint8: return take_bits<uint8_t>(file.stored, pixels);
        case VoxelType::int16: return take_bits<int16_t>(file.stored, pixels);
        case VoxelType::uint16: return take_bits<uint16_t>(file.stored, pixels);
        case VoxelType::int32: return take_bits<int32_t>(file.stored, pixels);
        default: return take_bits<uint32_t>(file.stored, pixels);
    }
}

void read_plain(const DicomFile& file, size_t frame, std::span<std::byte> pixels)
{
    const DicomLayout& layout = file.stored.layout;
    const std::unique_ptr<VoxelBytes> input = bytes_of_file(open_input_file(file.path), 0);
    input->read(layout.pixels_at + int64_t(frame * pixels.size()), pixels);
    const size_t of_number = std::max<size_t>(bytes_of(file.type), layout.pixels_are_words ? 2 : 1);
    if (layout.is_big_endian && of_number > 1) turn_bytes(pixels, of_number);
}

/// The fragments of a frame's encoded picture.
std::span<const DicomLayout::Fragment> fragments_of(const DicomFile& file, size_t frame)
{
    const std::span<const DicomLayout::Fragment> fragments = file.stored.layout.fragments;
    const bool is_only = file.frames.size() == 1;
    if (!is_only && fragments.size() != file.frames.size())
        fail(file.path.string(), ": Pixel Data has ", fragments.size(), " fragments; expected ", file.frames.size(),
             ", one for each frame");
    return is_only ? fragments : fragments.subspan(frame, 1);
}

/// The encoded picture of a frame.
std::vector<std::byte> bytes_of_picture(const DicomFile& file, size_t frame)
{
    const std::unique_ptr<VoxelBytes> input = bytes_of_file(open_input_file(file.path), 0);
    std::vector<std::byte> picture;
    for (const DicomLayout::Fragment& fragment : fragments_of(file, frame)) {
        const size_t begin = picture.size();
        picture.resize(begin + size_t(fragment.bytes));
        input->read(fragment.at, std::span(picture).subspan(begin));
    }
    return picture;
}

/// Returns the encoded `picture` in the form that GDCM expects: a sequence of fragments.
gdcm::SmartPointer<gdcm::SequenceOfFragments> sequence_of(const DicomFile& file, std::span<const std::byte> picture)
{
    if (picture.size() > UINT32_MAX)
        fail(file.path.string(), ": a coded picture has ", picture.size(), " bytes; expected at most ", UINT32_MAX);
    gdcm::Fragment fragment;
    fragment.SetByteValue(reinterpret_cast<const char*>(picture.data()), gdcm::VL(uint32_t(picture.size())));
    gdcm::SmartPointer<gdcm::SequenceOfFragments> sequence = new gdcm::SequenceOfFragments;
    sequence->AddFragment(fragment);
    return sequence;
}

/// Whether the codec supports the file's transfer syntax and succeeds in decoding all pixels of the picture.
template <class Codec>
bool decodes(const DicomFile& file, const gdcm::DataElement& picture, std::span<std::byte> pixels)
{
    const DicomStored& stored = file.stored;
    Codec codec;
    if (!codec.CanDecode(gdcm::TransferSyntax::GetTSType(stored.layout.transfer_syntax.c_str()))) return false;
    codec.SetNumberOfDimensions(2);
    codec.SetDimensions({unsigned(file.columns), unsigned(file.rows), 1});
    codec.SetPlanarConfiguration(0);
    codec.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
    codec.SetPixelFormat(gdcm::PixelFormat(1, uint16_t(8 * bytes_of(file.type)), uint16_t(stored.bits),
                                           uint16_t(stored.high_bit), uint16_t(stored.is_signed)));
    if constexpr (requires { codec.SetBufferLength(pixels.size()); }) codec.SetBufferLength(pixels.size());
    gdcm::DataElement decoded;
    if (!codec.Decode(picture, decoded)) return false;
    const gdcm::ByteValue* bytes = decoded.GetByteValue();
    if (bytes == nullptr || bytes->GetLength() < pixels.size()) return false;  // larger if padded to an even length
    std::memcpy(pixels.data(), bytes->GetPointer(), pixels.size());
    return true;
}

void decode(const DicomFile& file, size_t frame, std::span<std::byte> pixels)
{
    const std::vector<std::byte> bytes = bytes_of_picture(file, frame);
    if (is_jpeg_2000(file.stored.layout.transfer_syntax))
        return decode_jpeg_2000(sentence(file.path.string(), ": slice ", frame + 1), bytes, file.columns, file.rows,
                                pixels);
    gdcm::DataElement picture(gdcm::Tag(0x7fe0, 0x0010));
    const GdcmTurn turn;
    try {
        picture.SetValue(*sequence_of(file, bytes));
        if (decodes<gdcm::JPEGCodec>(file, picture, pixels) || decodes<gdcm::JPEGLSCodec>(file, picture, pixels) ||
            decodes<gdcm::RLECodec>(file, picture, pixels))
            return;
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        fail(file.path.string(), ": slice ", frame + 1, " cannot be decoded (", in_quotes(error.what()),
             "); expected pixel data that GDCM can decode");
    }
    fail(file.path.string(), ": slice ", frame + 1, " cannot be decoded; expected ", file.columns, "x", file.rows,
         " pixels of ", name_of(file.type), " in a format that GDCM can decode");
}

}  // namespace

std::vector<std::byte> read_dicom_pixels(const DicomFile& file, size_t frame, size_t bytes)
{
    std::vector<std::byte> pixels(bytes);
    if (file.stored.layout.is_encapsulated)
        decode(file, frame, pixels);
    else
        read_plain(file, frame, pixels);
    if (!is_float(file.type)) take_bits(file, pixels);
    return pixels;
}

}  // namespace shvr
