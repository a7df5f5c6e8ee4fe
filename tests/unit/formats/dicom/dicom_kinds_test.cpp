// Kinds of DICOM files that scanners and exports make apart from the usual series.

#include <cmath>
#include <cstring>

#include <doctest/doctest.h>

#include "engine/formats/choice.h"
#include "engine/formats/dicom/dicom_text.h"
#include "engine/formats/open_volume.h"
#include "tests/support/volume_files.h"
#include "tests/unit/formats/dicom/dicom_builder.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

constexpr const char* UPRIGHT = "1\\0\\0\\0\\1\\0";

/// One file with the frames of the phantom in this order; its position and distance are those of the file alone.
Dicom frames_of(const std::vector<int64_t>& order)
{
    Dicom file = image_of(0);
    std::string pixels;
    for (const int64_t z : order) pixels += image_of(z).elements[PIXELS].bytes;
    file.elements[PIXELS].bytes = pixels;
    file.text(0x00280008, "IS", std::to_string(order.size()));
    file.text(POSITION, "DS", "10\\20\\30").text(ORIENTATION, "DS", UPRIGHT).text(SPACING, "DS", "0.5\\0.5");
    return file;
}

Dicom place_of(const std::string& position)
{
    return Dicom().text(POSITION, "DS", position);
}

std::unique_ptr<VolumeSource> opened(TemporaryFolder& folder, const std::vector<Dicom>& files,
                                     const OpenOptions& options = {})
{
    for (size_t i = 0; i < files.size(); ++i) folder.write(sentence("d", i, ".dcm"), files[i].file());
    return open_volume(folder.path, options);
}

std::string refusal(const fs::path& path, const OpenOptions& options = {})
{
    return error_of([&] { open_volume(path, options); });
}

}  // namespace

// Kind (DICOM): frames with one position; a negative distance between slices
TEST_CASE("frames of one position are slices, at the distance that is stated, in the direction of its sign")
{
    for (const char* distance : {"1.25", "-1.25"}) {
        CAPTURE(std::string(distance));
        TemporaryFolder folder;
        const bool is_down = distance[0] == '-';
        Dicom file = frames_of(is_down ? std::vector<int64_t>{2, 1, 0} : std::vector<int64_t>{0, 1, 2});
        file.text(0x00180088, "DS", distance);
        const auto source = opened(folder, {file});
        CHECK(is_chirality_phantom(*source));
        CHECK(source->info().spacing == glm::dvec3(0.5, 0.5, 1.25));
        CHECK(source->info().origin == glm::dvec3(10, 20, is_down ? 27.5 : 30));
        CHECK(warns_of(*source, "all 3 slices state one position; they are stacked in order"));
    }
    // Positions of each frame, all equal.
    TemporaryFolder folder;
    Dicom file = frames_of({0, 1, 2});
    const Dicom place = Dicom().sequence(0x00209113, {place_of("1\\2\\3")});
    file.sequence(0x52009230, {place, place, place}).text(0x00180050, "DS", "2");
    const auto source = opened(folder, {file});
    CHECK(is_chirality_phantom(*source));
    CHECK(source->info().spacing.z == 2.0);
    CHECK(source->info().origin == glm::dvec3(1, 2, 3));
}

// Kind (DICOM): positions both in the file and in its frames
TEST_CASE("positions of frames count before one of the file")
{
    TemporaryFolder folder;
    Dicom file = frames_of({2, 0, 1});
    std::vector<Dicom> frames;
    for (const char* z : {"5", "3", "4"})
        frames.push_back(Dicom().sequence(0x00209113, {place_of(sentence("1\\2\\", z))}));
    file.sequence(0x52009230, frames);
    const auto source = opened(folder, {file});
    CHECK(is_chirality_phantom(*source));
    CHECK(source->info().spacing.z == 1.0);
    CHECK(source->info().origin == glm::dvec3(1, 2, 3));
}

// Kind (DICOM): enhanced files with shared functional groups
TEST_CASE("shared functional groups state the distance between frames without positions")
{
    TemporaryFolder folder;
    Dicom file = frames_of({0, 1, 2});
    file.elements.erase(POSITION);
    file.elements.erase(SPACING);
    file.sequence(
        0x52009229,
        {Dicom().sequence(
            0x00289110,
            {Dicom().text(SPACING, "DS", "0.5\\0.5").text(0x00180088, "DS", "0").text(0x00180050, "DS", "3")})});
    const auto source = opened(folder, {file});
    CHECK(is_chirality_phantom(*source));
    CHECK(source->info().spacing == glm::dvec3(0.5, 0.5, 3.0));
    CHECK(warns_of(*source, "slices are taken to be 3 mm apart"));
}

// Kind (DICOM): slices stored as time points
TEST_CASE("times of one place are time points, and can be stacked")
{
    TemporaryFolder folder;
    Dicom file = frames_of({0, 1, 2});
    std::vector<Dicom> frames;
    for (const uint32_t time : {1, 2, 3}) {
        Dicom content;
        content.elements[0x00209128] = {"UL", little(time, 4)};
        frames.push_back(Dicom().sequence(0x00209111, {content}));
    }
    file.sequence(0x52009230, frames).text(0x00180088, "DS", "1");
    folder.write("d.dcm", file.file());
    CHECK(contains(refusal(folder.path), "holds 3 time points; expected frame to choose one: 1 to 3"));
    CHECK(open_volume(folder.path, {.frame = "2"})->info().size.z == 1);
    CHECK(is_chirality_phantom(*open_volume(folder.path, {.frame = "z"})));
}

// Kind (DICOM): several stacks in one file
TEST_CASE("of several stacks of a file, one is chosen")
{
    TemporaryFolder folder;
    Dicom file = frames_of({7, 0, 8, 1, 2});
    std::vector<Dicom> frames;
    for (const int64_t z : {7, 0, 8, 1, 2}) {
        const Dicom content = Dicom().text(0x00209056, "SH", z < 3 ? "A" : "B");
        const Dicom orientation = Dicom().text(ORIENTATION, "DS", z < 3 ? UPRIGHT : "0\\1\\0\\0\\0\\1");
        const Dicom place = place_of(z < 3 ? sentence("0\\0\\", z) : sentence(z, "\\0\\0"));
        frames.push_back(
            Dicom().sequence(0x00209111, {content}).sequence(0x00209113, {place}).sequence(0x00209116, {orientation}));
    }
    file.sequence(0x52009230, frames);
    folder.write("d.dcm", file.file());
    CHECK(contains(refusal(folder.path),
                   "holds 2 stacks of slices; expected a frame, one of: stack A (3 slices), stack B (2 slices)"));
    CHECK(is_chirality_phantom(*open_volume(folder.path, {.frame = "stack A"})));
    CHECK(open_volume(folder.path, {.frame = "stack B"})->info().size.z == 2);
    CHECK(contains(refusal(folder.path, {.frame = "stack C"}), "frame is \"stack C\"; expected a frame, one of: "));
}

// Kind (DICOM): direction cosines that differ by rounding
TEST_CASE("directions that differ by rounding are one, wherever the rounded ones would part")
{
    TemporaryFolder folder;
    std::vector<Dicom> slices;
    for (const int64_t z : {0, 1, 2}) {
        const double jitter = z % 2 == 0 ? 0.000499999 : 0.000500001;
        slices.push_back(slice_of(z));
        slices.back().text(ORIENTATION, "DS", sentence("1\\", jitter, "\\0\\", -jitter, "\\1\\0"));
    }
    const auto source = opened(folder, slices);
    CHECK(is_chirality_phantom(*source));
    CHECK(source->info().spacing.z == doctest::Approx(1.25));
    CHECK(source->info().warnings.empty());
}

// Kind (DICOM): pixel spacing that changes within a series
TEST_CASE("a pixel spacing that changes within a series is told")
{
    TemporaryFolder folder;
    std::vector<Dicom> slices = {slice_of(0), slice_of(1), slice_of(2)};
    slices[1].text(SPACING, "DS", "0.6\\0.6");
    CHECK(warns_of(*opened(folder, slices),
                   "Pixel Spacing changes within the series: 1 slice, the first of them d1.dcm, "
                   "states 0.6 x 0.6 mm, the first slice 0.5 x 0.5 mm"));
}

// Kind (DICOM): a slice scanned twice
TEST_CASE("a slice scanned twice is named by its place, and one of them is chosen")
{
    TemporaryFolder folder;
    Dicom again = slice_of(1);
    again.text(0x00080018, "UI", "1.2.99").text(0x00200013, "IS", "9");
    again.elements[PIXELS].bytes[0] = 77;
    std::vector<Dicom> slices = {slice_of(0), slice_of(1), slice_of(2), again};
    for (size_t i = 0; i < slices.size(); ++i) folder.write(sentence("d", i, ".dcm"), slices[i].file());
    CHECK(contains(refusal(folder.path),
                   "holds 2 slices at 31.25 mm (d3.dcm), but 1 at most other positions; expected "
                   "frame \"first\" or \"last\", to take one at each"));
    const auto first = open_volume(folder.path, {.frame = "first"}), last = open_volume(folder.path, {.frame = "last"});
    CHECK(is_chirality_phantom(*first));
    CHECK((voxels_of<int16_t>(*last)[20] & 255) == 77);
    CHECK(warns_of(*last, "the last slice at each position is read"));
    CHECK_THROWS_AS(open_volume(folder.path), ChoiceNeeded);
}

// Kind (DICOM): one file of a series of multi-frame files
TEST_CASE("one file of many frames stands for a series that others continue")
{
    TemporaryFolder folder;
    const auto part = [](const std::vector<int64_t>& order, const char* uid) {
        Dicom file = frames_of(order);
        std::vector<Dicom> frames;
        for (const int64_t z : order)
            frames.push_back(Dicom().sequence(0x00209113, {place_of(sentence("10\\20\\", 30.0 + 1.25 * double(z)))}));
        return file.sequence(0x52009230, frames).text(0x00080018, "UI", uid);
    };
    folder.write("a.dcm", part({0, 1}, "1.1").file());
    const fs::path second = folder.write("b.dcm", part({2, 3}, "1.2").file());
    CHECK(open_volume(second)->info().size.z == 4);
    CHECK(warns_of(*open_volume(second), "all 2 files of the series are read"));
    // Another volume of the same series, at the same places.
    folder.write("a.dcm", part({2, 3}, "1.1").file());
    CHECK(open_volume(second)->info().size.z == 2);
    CHECK(warns_of(*open_volume(second), "one of the 2 files of its series is read"));
}

// Kind (DICOM): text in a character set other than UTF-8
TEST_CASE("texts are shown and chosen in UTF-8, whatever character set they are stored in")
{
    CHECK(dicom_text("plain", "") == "plain");
    CHECK(dicom_text("Bl\xc3\xbcte", "ISO_IR 192") == "Bl\xc3\xbcte");
    CHECK(dicom_text("Bl\xfcte", "ISO_IR 100") == "Bl\xc3\xbcte");
    CHECK(dicom_text("Bl\xfcte", "") == "Bl\xc3\xbcte");
    CHECK(dicom_text("Bl\xfcte", "\\ISO 2022 IR 100") == "Bl\xc3\xbcte");
    CHECK(dicom_text("\xbb\xd5", "no such set") == "\xc2\xbb\xc3\x95");
    CHECK(dicom_text("\xfc\xff\xfe", "ISO_IR 192") == "\xc3\xbc\xc3\xbf\xc3\xbe");
    TemporaryFolder folder;
    Dicom other = slice_of(0);
    other.text(0x0020000e, "UI", "1.2.10").text(0x0008103e, "LO", "Stiel");
    std::vector<Dicom> slices = {slice_of(0), slice_of(1), slice_of(2)};
    for (Dicom& slice : slices) slice.text(0x00080005, "CS", "ISO_IR 100").text(0x0008103e, "LO", "Bl\xfcte");
    slices.push_back(other);
    for (size_t i = 0; i < slices.size(); ++i) folder.write(sentence("d", i, ".dcm"), slices[i].file());
    CHECK(contains(refusal(folder.path), "\"Bl\xc3\xbcte\" (3 slices)"));
    CHECK(is_chirality_phantom(*open_volume(folder.path, {.channel = "Bl\xc3\xbcte"})));
}

// Kind (DICOM): Float and Double Float Pixel Data
TEST_CASE("floats in Float Pixel Data and Double Float Pixel Data are read as they are")
{
    for (const uint32_t tag : {0x7fe00008u, 0x7fe00009u})
        for (const char* syntax : {EXPLICIT_LITTLE, IMPLICIT_LITTLE}) {
            CAPTURE(tag);
            TemporaryFolder folder;
            Dicom file = slice_of(0);
            file.transfer_syntax = syntax;
            const bool is_double = (tag & 15u) == 9;
            file.elements.erase(PIXELS);
            file.number(0x00280100, is_double ? 64 : 32);
            std::string pixels;
            for (int i = 0; i < 20; ++i) {
                const double wide = 0.25 * i - 1.0;
                const auto narrow = float(wide);
                char bytes[8];
                std::memcpy(bytes, is_double ? static_cast<const void*>(&wide) : &narrow, is_double ? 8 : 4);
                pixels.append(bytes, is_double ? 8 : 4);
            }
            file.elements[tag] = {is_double ? "OD" : "OF", pixels};
            const auto source = open_volume(folder.write("f.dcm", file.file()));
            CHECK(source->info().type == (is_double ? VoxelType::float64 : VoxelType::float32));
            if (is_double) CHECK(voxels_of<double>(*source)[7] == 0.75);
            if (!is_double) CHECK(voxels_of<float>(*source)[7] == 0.75f);
            file.number(0x00280100, 16);
            CHECK(contains(refusal(folder.write("f.dcm", file.file())), "Bits Allocated is 16; expected "));
        }
}

// Kind (DICOM): files without preamble; folders of folders
TEST_CASE("files without preamble, and folders of folders, are opened")
{
    for (const char* syntax : {EXPLICIT_LITTLE, IMPLICIT_LITTLE}) {
        CAPTURE(std::string(syntax));
        TemporaryFolder folder;
        fs::create_directories(folder.path / "DICOM/PAT1/SER1");
        folder.write("notes.txt", "no slice");
        for (const int64_t z : {0, 1, 2}) {
            Dicom slice = slice_of(z);
            slice.transfer_syntax = syntax;
            folder.write(sentence("DICOM/PAT1/SER1/IM", z), slice.data_set());
        }
        CHECK(is_chirality_phantom(*open_volume(folder.path)));
        CHECK(is_chirality_phantom(*open_volume(folder.path / "DICOM/PAT1/SER1/IM1")));
    }
    TemporaryFolder folder;
    const std::string data = slice_of(0).data_set();
    for (const size_t length : {size_t{8}, size_t{20}, data.size() / 2, data.size() - 1})
        CHECK(contains(refusal(folder.write("cut", data.substr(0, length))), "is in no format known here"));
}
