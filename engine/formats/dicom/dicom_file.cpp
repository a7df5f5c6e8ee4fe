#include "engine/formats/dicom/dicom_file.h"

#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/dicom/dicom_jpeg.h"
#include "engine/formats/dicom/dicom_rle.h"
#include "engine/formats/dicom/dicom_text.h"
#include "engine/formats/dicom/gdcm_turn.h"

namespace shvr {
namespace {

using gdcm::DataSet;
using gdcm::Tag;

constexpr int64_t MAX_FRAMES = 65536;
/// Slices above LARGE_SLICE bytes may be at most MAX_EXPANSION times their file's size; no codec exceeds that.
constexpr int64_t LARGE_SLICE = int64_t{64} << 20;
constexpr int64_t MAX_EXPANSION = 1000;

// ---- Values ---------------------------------------------------------------------------------------------------------

/// Looks up values in several data sets; the first set that has a value takes precedence.
class Values {
public:
    explicit Values(std::vector<const DataSet*> sets) : sets_(std::move(sets)) {}

    /// Returns the text up to the first NUL, without padding spaces, in UTF-8.
    std::string text(const Tag& tag) const
    {
        const gdcm::ByteValue* value = find(tag);
        if (value == nullptr) return {};
        const std::string_view bytes(value->GetPointer(), value->GetLength());
        return dicom_text(trimmed(bytes.substr(0, bytes.find('\0'))), character_set());
    }
    /// Returns numbers stored as text, separated by backslashes; empty if any of them is not a number.
    std::vector<double> decimals(const Tag& tag) const
    {
        std::string words = text(tag);
        std::replace(words.begin(), words.end(), '\\', ' ');
        std::vector<double> numbers;
        for (const std::string_view word : words_of(words)) {
            const std::optional<double> number = number_of(word);
            if (!number || !std::isfinite(*number)) return {};
            numbers.push_back(*number);
        }
        return numbers;
    }
    std::optional<double> decimal(const Tag& tag) const
    {
        const std::vector<double> numbers = decimals(tag);
        return numbers.size() == 1 ? std::optional(numbers[0]) : std::nullopt;
    }
    int64_t whole(const Tag& tag) const { return whole_of(text(tag)).value_or(0); }
    /// Returns a binary number: `Number` is uint16_t for type US, and uint32_t for UL.
    template <class Number>
    int64_t number(const Tag& tag, int64_t fallback) const
    {
        const gdcm::ByteValue* value = find(tag);
        Number number = 0;
        if (value == nullptr || value->GetLength() < sizeof(number)) return fallback;
        std::memcpy(&number, value->GetPointer(), sizeof(number));
        return number;
    }

private:
    std::string_view character_set() const
    {
        const gdcm::ByteValue* value = find(Tag(0x0008, 0x0005));
        return value == nullptr ? std::string_view() : std::string_view(value->GetPointer(), value->GetLength());
    }
    const gdcm::ByteValue* find(const Tag& tag) const
    {
        for (const DataSet* set : sets_) {
            if (!set->FindDataElement(tag)) continue;
            const gdcm::ByteValue* value = set->GetDataElement(tag).GetByteValue();
            if (value != nullptr && value->GetPointer() != nullptr) return value;
        }
        return nullptr;
    }

    std::vector<const DataSet*> sets_;
};

using Sequence = gdcm::SmartPointer<gdcm::SequenceOfItems>;

/// Null if there is none.
Sequence sequence_of(const DataSet& set, const Tag& tag)
{
    return set.FindDataElement(tag) ? set.GetDataElement(tag).GetValueAsSQ() : Sequence();
}

/// The data sets that may state a value of one frame, in order of precedence: the per-frame functional groups, the
/// shared functional groups (PS3.3, C.7.6.16), and the file's own data set.
class FrameValues {
public:
    explicit FrameValues(const DataSet& file)
        : file_(file), of_each_(sequence_of(file, Tag(0x5200, 0x9230))), of_all_(sequence_of(file, Tag(0x5200, 0x9229)))
    {}

    /// Valid until the next call.
    Values of(size_t frame)
    {
        groups_.clear();
        std::vector<const DataSet*> sets;
        add_groups(of_each_, frame, sets);
        add_groups(of_all_, 0, sets);
        sets.push_back(&file_);
        return Values(std::move(sets));
    }

private:
    void add_groups(const Sequence& items, size_t index, std::vector<const DataSet*>& sets)
    {
        if (items == nullptr || items->GetNumberOfItems() <= index) return;
        const DataSet& item = items->GetItem(index + 1).GetNestedDataSet();
        for (const Tag& tag : {Tag(0x0020, 0x9111), Tag(0x0020, 0x9113), Tag(0x0020, 0x9116), Tag(0x0028, 0x9110),
                               Tag(0x0028, 0x9145)}) {
            const Sequence group = sequence_of(item, tag);
            if (group == nullptr || group->GetNumberOfItems() == 0) continue;
            groups_.push_back(group);  // keeps its data set alive
            sets.push_back(&group->GetItem(1).GetNestedDataSet());
        }
    }

    const DataSet& file_;
    Sequence of_each_, of_all_;
    std::vector<Sequence> groups_;
};

// ---- Header ---------------------------------------------------------------------------------------------------------

[[noreturn]] void refuse(const DicomFile& file, const char* field, const std::string& found, const char* expected)
{
    fail(file.path.string(), ": ", field, " is ", found, "; expected ", expected);
}

/// Returns the voxel type of a file with Float Pixel Data or Double Float Pixel Data (PS3.3, C.7.6.24 and C.7.6.25).
VoxelType read_float_type(DicomFile& file, int64_t allocated, std::optional<ValueRange>& stored)
{
    const bool is_double = file.stored.layout.numbers == DicomLayout::Numbers::float64;
    if (allocated != (is_double ? 64 : 32))
        refuse(file, "Bits Allocated", std::to_string(allocated), is_double ? "64" : "32");
    constexpr double MOST = std::numeric_limits<float>::max();
    stored = ValueRange{-MOST, MOST};
    file.stored.bits = int(allocated);
    file.stored.high_bit = int(allocated) - 1;
    file.stored.is_signed = true;
    return is_double ? VoxelType::float64 : VoxelType::float32;
}

VoxelType read_type(DicomFile& file, const Values& values, std::optional<ValueRange>& stored)
{
    const int64_t allocated = values.number<uint16_t>(Tag(0x0028, 0x0100), 0);
    const int64_t bits = values.number<uint16_t>(Tag(0x0028, 0x0101), allocated);
    const bool is_signed = values.number<uint16_t>(Tag(0x0028, 0x0103), 0) == 1;
    if (allocated != 8 && allocated != 16 && allocated != 32 &&
        file.stored.layout.numbers == DicomLayout::Numbers::whole) {
        refuse(file, "Bits Allocated", std::to_string(allocated), "8, 16 or 32");
    }
    if (file.stored.layout.numbers != DicomLayout::Numbers::whole) return read_float_type(file, allocated, stored);
    if (bits < 1 || bits > allocated) refuse(file, "Bits Stored", std::to_string(bits), "1 to Bits Allocated");
    const int64_t high = values.number<uint16_t>(Tag(0x0028, 0x0102), bits - 1);
    if (high < bits - 1 || high >= allocated)
        refuse(file, "High Bit", std::to_string(high), sentence(bits - 1, ", to Bits Allocated - 1").c_str());
    file.stored.bits = int(bits);
    file.stored.high_bit = int(high);
    file.stored.is_signed = is_signed;
    const double values_there_are = std::ldexp(1.0, int(bits));
    stored = is_signed ? ValueRange{-0.5 * values_there_are, 0.5 * values_there_are - 1.0}
                       : ValueRange{0.0, values_there_are - 1.0};
    if (allocated == 8) return is_signed ? VoxelType::int8 : VoxelType::uint8;
    if (allocated == 16) return is_signed ? VoxelType::int16 : VoxelType::uint16;
    return is_signed ? VoxelType::int32 : VoxelType::uint32;
}

Rescale read_rescale(const DicomFile& file, const Values& values, const ValueRange& stored)
{
    Rescale rescale{.slope = values.decimal(Tag(0x0028, 0x1053)).value_or(1.0),
                    .intercept = values.decimal(Tag(0x0028, 0x1052)).value_or(0.0),
                    .stored = stored};
    if (rescale.slope == 0.0) rescale.slope = 1.0;
    if (file.is_inverted) {
        rescale.intercept += rescale.slope * (stored.lower + stored.upper);
        rescale.slope = -rescale.slope;
    }
    return rescale;
}

/// Returns Spacing Between Slices or, if that is missing or 0 (as in some files), Slice Thickness.
std::optional<double> read_distance(const Values& values)
{
    const std::optional<double> spacing = values.decimal(Tag(0x0018, 0x0088));
    if (spacing && *spacing != 0.0) return spacing;
    const std::optional<double> thickness = values.decimal(Tag(0x0018, 0x0050));
    return thickness && *thickness > 0.0 ? thickness : std::nullopt;
}

DicomFrame read_frame(const Values& values, DicomFile& file, const ValueRange& stored)
{
    DicomFrame frame;
    if (const std::vector<double> p = values.decimals(Tag(0x0020, 0x0032)); p.size() == 3) {
        frame.position = glm::dvec3(p[0], p[1], p[2]);
    }
    if (const std::vector<double> a = values.decimals(Tag(0x0020, 0x0037)); a.size() == 6) {
        const glm::dvec3 x(a[0], a[1], a[2]), y(a[3], a[4], a[5]);
        frame.has_orientation = glm::length(glm::cross(x, y)) > 0.1 && glm::length(x) < 2.0 && glm::length(y) < 2.0;
        if (frame.has_orientation) {
            frame.along_x = glm::normalize(x);
            frame.along_y = glm::normalize(y);
        }
    }
    std::vector<double> spacing = values.decimals(Tag(0x0028, 0x0030));
    if (spacing.size() != 2) {
        spacing = values.decimals(Tag(0x0018, 0x1164));
        file.spacing_is_at_detector = spacing.size() == 2;
    }
    // DICOM states the spacing between rows, along y, before the spacing between columns, along x.
    if (spacing.size() == 2 && spacing[0] > 0.0 && spacing[1] > 0.0) frame.spacing = glm::dvec2(spacing[1], spacing[0]);
    frame.distance = read_distance(values);
    frame.time_number = values.number<uint32_t>(Tag(0x0020, 0x9128), 0);
    frame.stack = values.text(Tag(0x0020, 0x9056));
    frame.rescale = read_rescale(file, values, stored);
    return frame;
}

int64_t read_number_of_frames(const DicomFile& file, const Values& values)
{
    const std::string text = values.text(Tag(0x0028, 0x0008));
    if (text.empty()) return 1;
    const int64_t frames = whole_of(text).value_or(0);
    if (frames < 1 || frames > MAX_FRAMES) refuse(file, "Number of Frames", in_quotes(text), "1 to 65536");
    return frames;
}

void check_size(const DicomFile& file, int64_t frames, const DicomLayout& layout)
{
    const int64_t slice = file.columns * file.rows * int64_t(bytes_of(file.type));
    if (!layout.is_encapsulated && layout.pixel_bytes < slice * frames) {
        fail(file.path.string(), ": Pixel Data holds ", layout.pixel_bytes, " bytes; expected ", slice * frames,
             " for ", frames, " slices of ", file.columns, "x", file.rows, " pixels of ", name_of(file.type));
    }
    if (layout.is_encapsulated && slice > LARGE_SLICE && layout.pixel_bytes * MAX_EXPANSION < slice) {
        fail(file.path.string(), ": Pixel Data holds ", layout.pixel_bytes, " compressed bytes; expected enough for ",
             file.columns, "x", file.rows, " pixels");
    }
}

void read_values(const DataSet& set, const DicomLayout& layout, DicomFile& file)
{
    const Values values({&set});
    file.series_uid = values.text(Tag(0x0020, 0x000e));
    file.series_description = values.text(Tag(0x0008, 0x103e));
    file.series_number = values.whole(Tag(0x0020, 0x0011));
    file.instance_uid = values.text(Tag(0x0008, 0x0018));
    file.instance_number = values.whole(Tag(0x0020, 0x0013));
    file.time_number = values.whole(Tag(0x0020, 0x0100));
    if (file.time_number == 0) file.time_number = values.whole(Tag(0x0020, 0x0012));
    file.columns = values.number<uint16_t>(Tag(0x0028, 0x0011), 0);
    file.rows = values.number<uint16_t>(Tag(0x0028, 0x0010), 0);
    if (file.columns == 0 || file.rows == 0) refuse(file, "Rows or Columns", "missing or 0", "1 to 65535");
    const int64_t samples = values.number<uint16_t>(Tag(0x0028, 0x0002), 1);
    const std::string colors = values.text(Tag(0x0028, 0x0004));
    if (samples != 1 || (!colors.empty() && colors != "MONOCHROME1" && colors != "MONOCHROME2")) {
        refuse(file, "Photometric Interpretation", in_quotes(colors),
               "MONOCHROME1 or MONOCHROME2, which have one sample per pixel");
    }
    file.is_inverted = colors == "MONOCHROME1";
    file.tilt_degrees = values.decimal(Tag(0x0018, 0x1120)).value_or(0.0);
    std::optional<ValueRange> stored;
    file.type = read_type(file, values, stored);
    const int64_t frames = read_number_of_frames(file, values);
    check_size(file, frames, layout);
    FrameValues frame_values(set);
    for (int64_t i = 0; i < frames; ++i) {
        file.frames.push_back(read_frame(frame_values.of(size_t(i)), file, *stored));
    }
}

}  // namespace

std::optional<DicomFile> read_dicom_file(const std::filesystem::path& path)
{
    const InputFile input = open_input_file(path);
    const std::optional<DicomLayout> layout = check_dicom_layout(input);
    if (!layout || layout->pixel_bytes == 0) return {};
    const GdcmTurn turn;
    gdcm::Reader reader;
    reader.SetFileName(path.c_str());
    const Tag pixels(0x7fe0, layout->pixel_element());
    DicomFile file{.path = path, .stored = {.layout = *layout}};
    try {
        if (!reader.ReadUpToTag(pixels, {pixels})) fail(path.string(), ": GDCM cannot read it; expected a DICOM file");
        read_values(reader.GetFile().GetDataSet(), *layout, file);
        if (is_jpeg(layout->transfer_syntax)) check_jpeg_headers(input, layout->fragments, file.columns, file.rows);
        if (is_rle(layout->transfer_syntax)) check_rle_headers(input, layout->fragments, int64_t(bytes_of(file.type)));
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        fail(path.string(), ": GDCM cannot read it (", in_quotes(error.what()), "); expected a DICOM file");
    }
    return file;
}

}  // namespace shvr
