#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include <doctest/doctest.h>
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>

#include "engine/formats/open_volume.h"
#include "tests/support/volume_files.h"
#include "tests/unit/formats/dicom/dicom_builder.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

/// `a.dcm` ... in arbitrary order.
fs::path folder_of(const TemporaryFolder& folder, const std::vector<Dicom>& slices)
{
    for (size_t i = 0; i < slices.size(); ++i) {
        folder.write(sentence("dicom_", (i * 7 + 3) % slices.size()), slices[i].file());
    }
    return folder.path;
}

std::vector<Dicom> phantom_slices()
{
    return {slice_of(0), slice_of(1), slice_of(2)};
}

std::string refusal(const fs::path& path, const OpenOptions& options = {})
{
    return error_of([&] {
        const auto source = open_volume(path, options);
        std::vector<std::byte> voxels(size_t(voxel_count(source->info())) * bytes_of(source->info().type));
        source->read({Size3(0), source->info().size}, voxels);
    });
}

}  // namespace

TEST_CASE("a folder of DICOM slices is the chirality phantom, in every uncompressed form")
{
    for (const char* syntax : {EXPLICIT_LITTLE, IMPLICIT_LITTLE, EXPLICIT_BIG}) {
        CAPTURE(std::string(syntax));
        const TemporaryFolder folder;
        std::vector<Dicom> slices = phantom_slices();
        for (Dicom& slice : slices) slice.transfer_syntax = syntax;
        folder_of(folder, slices);
        folder.write("readme.txt", "no slice");
        for (const fs::path& path : {folder.path, folder.path / "dicom_1"}) {
            const auto source = open_volume(path);
            CHECK(is_chirality_phantom(*source));
            CHECK(source->info().format == "dicom");
            CHECK(source->info().spacing == glm::dvec3(0.5, 0.5, 1.25));
            CHECK(source->info().unit == "mm");
            CHECK(source->info().frame == "LPS");
            CHECK(source->info().origin == glm::dvec3(10, 20, 30));
            CHECK(source->info().directions == glm::dmat3(1.0));
            CHECK(source->info().warnings.size() == (path == folder.path ? 0 : 1));
        }
        CHECK(warns_of(*open_volume(folder.path / "dicom_1"),
                       "one file of a series was opened; all 3 files of the series are read"));
    }
}

TEST_CASE("wherever the axes of DICOM slices run, every voxel stays at its place and no hand changes")
{
    for (const char* orientation :
         {"1\\0\\0\\0\\-1\\0", "-1\\0\\0\\0\\1\\0", "0\\1\\0\\0\\0\\-1", "0\\0\\1\\1\\0\\0", "0.8\\0.6\\0\\0\\0\\-1"}) {
        CAPTURE(std::string(orientation));
        const TemporaryFolder folder;
        std::vector<Dicom> slices = phantom_slices();
        for (Dicom& slice : slices) slice.text(ORIENTATION, "DS", orientation);
        // Positions run along the normal of the stated orientation, or against it.
        const auto flat = open_volume(folder_of(folder, {slices[0]}));
        const glm::dvec3 normal = glm::cross(flat->info().directions[0], flat->info().directions[1]);
        for (const double sign : {1.0, -1.0}) {
            for (size_t z = 0; z < 3; ++z) {
                const glm::dvec3 p = glm::dvec3(10, 20, 30) + sign * 1.25 * double(z) * normal;
                slices[z].text(POSITION, "DS", sentence(p.x, "\\", p.y, "\\", p.z));
            }
            const auto source = open_volume(folder_of(folder, slices));
            CHECK(glm::determinant(source->info().directions) == doctest::Approx(1.0));
            const std::vector<int16_t> voxels = voxels_of<int16_t>(*source);
            size_t wrong = 0;
            for (int i = 0; i < 60; ++i) {
                const glm::dvec3 index(i % 5, i / 5 % 4, i / 20);
                const glm::dvec3 position =
                    source->info().origin + source->info().directions * (source->info().spacing * index);
                // The slice's own pixel at that position.
                const glm::dvec3 away = position - glm::dvec3(10, 20, 30);
                const int64_t z = std::llround(sign * glm::dot(away, normal) / 1.25);
                const int64_t x = std::llround(glm::dot(away, flat->info().directions[0]) / 0.5);
                const int64_t y = std::llround(glm::dot(away, flat->info().directions[1]) / 0.5);
                wrong += voxels[size_t(i)] != phantom(x, y, z);
            }
            CHECK(wrong == 0);
        }
    }
}

TEST_CASE("compressed DICOM slices equal the ones they were made of")
{
    const TemporaryFolder plain;
    std::vector<Dicom> slices = phantom_slices();
    for (Dicom& slice : slices) {  // GDCM's own JPEG 2000 encoder crashes on tiny images
        slice.number(0x00280010, 64).number(0x00280011, 96);
        std::string pixels;
        for (int i = 0; i < 64 * 96; ++i) pixels += little(uint16_t(i * i % 1999 - 500), 2);
        slice.elements[PIXELS].bytes = pixels;
    }
    folder_of(plain, slices);
    const std::vector<int16_t> expected = voxels_of<int16_t>(*open_volume(plain.path));
    for (const gdcm::TransferSyntax::TSType syntax :
         {gdcm::TransferSyntax::JPEGLosslessProcess14_1, gdcm::TransferSyntax::JPEG2000Lossless,
          gdcm::TransferSyntax::JPEGLSLossless, gdcm::TransferSyntax::RLELossless}) {
        CAPTURE(int(syntax));
        const TemporaryFolder folder;
        for (const char* name : {"dicom_0", "dicom_1", "dicom_2"}) {
            gdcm::ImageReader reader;
            reader.SetFileName((plain.path / name).c_str());
            REQUIRE(reader.Read());
            gdcm::ImageChangeTransferSyntax change;
            change.SetTransferSyntax(gdcm::TransferSyntax(syntax));
            change.SetInput(reader.GetImage());
            REQUIRE(change.Change());
            gdcm::ImageWriter writer;
            writer.SetFile(reader.GetFile());
            writer.SetImage(change.GetOutput());
            writer.SetFileName((folder.path / name).c_str());
            REQUIRE(writer.Write());
        }
        const auto source = open_volume(folder.path);
        CHECK(source->info().spacing == glm::dvec3(0.5, 0.5, 1.25));
        CHECK(voxels_of<int16_t>(*source) == expected);
        std::string bytes = bytes_of_file(folder.path / "dicom_0");
        if (syntax != gdcm::TransferSyntax::RLELossless) {  // whose frames are one fragment each (PS3.5, A.4)
            const std::string item = little(0xfffe, 2) + little(0xe000, 2);
            const size_t table = bytes.find(item), first = bytes.find(item, table + 8);
            REQUIRE(first != std::string::npos);
            const auto length = size_t(uint8_t(bytes[first + 4]) | uint8_t(bytes[first + 5]) << 8);
            std::string split = bytes;
            split.replace(first + 4, 4, little(100, 4));
            split.insert(first + 108, item + little(length - 100, 4));
            const TemporaryFolder apart;
            const std::vector<int16_t> found = voxels_of<int16_t>(*open_volume(apart.write("a.dcm", split)));
            CHECK(std::ranges::equal(found, std::span(expected).first(found.size())));
        }
        // A picture that is not of the size that the file states is refused, not shown out of step.
        for (const auto& [tag, side] : {std::pair(0x10, 96), std::pair(0x11, 64)}) {
            const size_t at = bytes.find(little(0x28, 2) + little(uint64_t(tag), 2) + "US");
            REQUIRE(at != std::string::npos);
            bytes.replace(at + 8, 2, little(uint64_t(side), 2));
        }
        const TemporaryFolder turned;
        const std::string said = refusal(turned.write("a.dcm", bytes));
        if (syntax != gdcm::TransferSyntax::RLELossless)  // which has no size of its own
            CHECK(contains(said, "picture has 96x64 pixels of 1 components; expected 64x96 of one"));
    }
}

TEST_CASE("DICOM intensities are what stored numbers mean")
{
    const TemporaryFolder folder;
    std::vector<Dicom> slices = phantom_slices();
    for (Dicom& slice : slices) {
        slice.text(INTERCEPT, "DS", "-1024").text(SLOPE, "DS", "1");
        slice.number(0x00280101, 12).number(0x00280102, 11).number(0x00280103, 0);
        for (size_t i = 1; i < slice.elements[PIXELS].bytes.size(); i += 2) slice.elements[PIXELS].bytes[i] = 1;
    }
    const auto shifted = open_volume(folder_of(folder, slices));
    CHECK(shifted->info().type == VoxelType::int16);  // 12 bits, less 1024
    CHECK(voxels_of<int16_t>(*shifted)[0] == 256 + 157 - 1024);

    slices[1].text(SLOPE, "DS", "0.5");
    const auto varying = open_volume(folder_of(folder, slices));
    CHECK(varying->info().type == VoxelType::float32);
    CHECK(voxels_of<float>(*varying)[20] == 0.5f * (256 + 1) - 1024.0f);

    for (Dicom& slice : slices) slice.text(SLOPE, "DS", "2").text(0x00280004, "CS", "MONOCHROME1");
    const auto inverted = open_volume(folder_of(folder, slices));
    CHECK(inverted->info().type == VoxelType::int16);
    CHECK(voxels_of<int16_t>(*inverted)[0] == 2 * (4095 - 256 - 157) - 1024);
    CHECK(warns_of(*inverted, "low values are bright (MONOCHROME1); intensities are inverted"));
}

TEST_CASE("missing, doubled and odd DICOM slices are told")
{
    std::vector<std::unique_ptr<TemporaryFolder>> folders;  // slices are read on demand
    const auto opened = [&](const std::vector<Dicom>& slices) {
        folders.push_back(std::make_unique<TemporaryFolder>());
        return open_volume(folder_of(*folders.back(), slices));
    };
    const auto gap = opened({slice_of(0), slice_of(1), slice_of(2), slice_of(5), slice_of(6), slice_of(7)});
    CHECK(gap->info().size.z == 6);
    CHECK(gap->info().spacing.z == doctest::Approx(1.25));
    CHECK(warns_of(*gap, "slices 3 and 4 ("));
    CHECK(warns_of(
        *gap,
        "are 3.75 mm apart (2 slices missing), but most others are 1.25 mm apart; all are drawn at that distance"));

    Dicom moved = slice_of(3);
    moved.text(POSITION, "DS", "10\\20\\33.9");
    const auto uneven = opened({slice_of(0), slice_of(1), slice_of(2), moved});
    CHECK(warns_of(*uneven, "are 1.4 mm apart, but most others are 1.25 mm apart; all are drawn at that distance"));

    const auto copied = opened({slice_of(0), slice_of(1), slice_of(2), slice_of(1)});
    CHECK(copied->info().size.z == 3);
    CHECK(warns_of(*copied, "1 duplicate slice ignored"));

    std::vector<Dicom> times;
    for (const int64_t time : {1, 2}) {
        for (const int64_t z : {0, 1, 2}) {
            times.push_back(slice_of(z));
            times.back().text(0x00080018, "UI", sentence("1.", time, ".", z));
            times.back().text(0x00200013, "IS", sentence(100 - 10 * time - z)).text(0x00200100, "IS", sentence(time));
            times.back().elements[PIXELS].bytes[0] = char(time);
        }
    }
    const TemporaryFolder moving;
    folder_of(moving, times);
    CHECK(contains(refusal(moving.path), "holds 2 time points; expected frame to choose one: 1 to 2"));
    CHECK((voxels_of<int16_t>(*open_volume(moving.path, {.frame = "2"}))[20] & 255) == 2);
    times.pop_back();
    const TemporaryFolder ragged;
    folder_of(ragged, times);
    CHECK(contains(refusal(ragged.path), "holds 1 slice at 32.5 mm ("));
    CHECK(contains(refusal(ragged.path), "), but 2 at most other positions; expected frame \"first\" or \"last\""));

    Dicom scout = slice_of(9);
    scout.text(ORIENTATION, "DS", "0\\1\\0\\0\\0\\-1");
    const auto with_scout = opened({slice_of(0), slice_of(1), slice_of(2), scout});
    CHECK(is_chirality_phantom(*with_scout));
    CHECK(warns_of(*with_scout, "1 slice of another size, type or direction ignored"));

    std::vector<Dicom> tilted = phantom_slices();
    for (size_t z = 0; z < 3; ++z) {
        tilted[z].text(POSITION, "DS", sentence("10\\", 20.0 + 0.25 * double(z), "\\", 30.0 + 1.25 * double(z)));
        tilted[z].text(0x00181120, "DS", "11.3");
    }
    const auto sheared = opened(tilted);
    CHECK(warns_of(*sheared, "axes y and z meet at 78.7 degrees"));
    CHECK(warns_of(*sheared, "the gantry was tilted by 11.3 degrees"));
    CHECK(is_chirality_phantom(*sheared));

    std::vector<Dicom> placeless = {image_of(2), image_of(0), image_of(1)};
    for (Dicom& slice : placeless) slice.text(0x00180050, "DS", "3").text(0x00181164, "DS", "0.25\\0.75");
    const auto numbered = opened(placeless);
    CHECK(is_chirality_phantom(*numbered));
    CHECK(numbered->info().spacing == glm::dvec3(0.75, 0.25, 3));
    CHECK(warns_of(*numbered, "slices do not state their positions; they are sorted by instance number"));
    CHECK(warns_of(*numbered, "slices are taken to be 3 mm apart, the spacing or thickness that the file states"));
    CHECK(warns_of(*numbered, "that at the detector"));
    CHECK(warns_of(*opened({image_of(0)}), "no spacing stated"));
}

TEST_CASE("of several DICOM series, one is chosen by number or description")
{
    const TemporaryFolder folder;
    std::vector<Dicom> slices = phantom_slices();
    for (const int64_t z : {0, 1}) {
        slices.push_back(slice_of(z));
        slices.back()
            .text(0x0020000e, "UI", "1.2.10")
            .text(0x00200011, "IS", "2")
            .text(0x0008103e, "LO", "Scout lateral");
    }
    folder_of(folder, slices);
    CHECK(contains(refusal(folder.path),
                   "holds 2 series; expected a channel, the number or the description of one of: 1 \"Scout "
                   "lateral\" (2 slices), 2 \"Axial\" (3 slices)"));
    CHECK(is_chirality_phantom(*open_volume(folder.path, {.channel = "2"})));
    CHECK(is_chirality_phantom(*open_volume(folder.path, {.channel = "Axial"})));
    CHECK(open_volume(folder.path, {.channel = "1.2.10"})->info().size.z == 2);
    CHECK(contains(refusal(folder.path, {.channel = "3"}), "channel is \"3\"; expected a channel, the number"));
}

TEST_CASE("a DICOM file of many frames is a volume, in the order of their places")
{
    const TemporaryFolder folder;
    Dicom file = image_of(0);
    std::string pixels;
    std::vector<Dicom> frames;
    for (const int64_t z : {1, 2, 0}) {
        pixels += image_of(z).elements[PIXELS].bytes;
        Dicom place;
        place.text(POSITION, "DS", sentence("10\\20\\", 30.0 + 1.25 * double(z)));
        frames.push_back(Dicom().sequence(0x00209113, {place}));
    }
    file.elements[PIXELS].bytes = pixels;
    file.text(0x00280008, "IS", "3").sequence(0x52009230, frames);
    file.sequence(0x52009229, {Dicom()
                                   .sequence(0x00209116, {Dicom().text(ORIENTATION, "DS", "1\\0\\0\\0\\1\\0")})
                                   .sequence(0x00289110, {Dicom().text(SPACING, "DS", "0.5\\0.5")})});
    const fs::path path = folder.write("enhanced.dcm", file.file());
    const auto source = open_volume(path);
    CHECK(is_chirality_phantom(*source));
    CHECK(source->info().origin == glm::dvec3(10, 20, 30));
    CHECK(source->info().spacing == glm::dvec3(0.5, 0.5, 1.25));
    CHECK(source->info().warnings.empty());
    CHECK(is_chirality_phantom(*open_volume(folder.path)));

    const std::string whole = file.file();
    for (size_t length = 132; length < whole.size(); length += 1) {
        const std::string said = refusal(folder.write("enhanced.dcm", whole.substr(0, length)));
        CHECK(contains(said, "; expected "));
    }
    CHECK(contains(refusal(folder.write("enhanced.dcm", whole.substr(0, whole.size() - 2))),
                   "element (7fe0,0010) at byte "));
}

TEST_CASE("what makes no volume among DICOM files is left out with words, or refused where it is all there is")
{
    const TemporaryFolder folder;
    Dicom colors = slice_of(4);
    colors.number(0x00280002, 3).text(0x00280004, "CS", "RGB");
    Dicom report = slice_of(5);
    report.elements.erase(PIXELS);
    const std::string whole = slice_of(6).file();
    const std::string cut = whole.substr(0, whole.size() - 1);
    std::vector<Dicom> slices = phantom_slices();
    slices.push_back(colors);
    slices.push_back(report);
    folder_of(folder, slices);
    folder.write("cut", cut);
    const auto source = open_volume(folder.path);
    CHECK(is_chirality_phantom(*source));
    CHECK(warns_of(*source, "2 files ignored, the first because "));

    const auto alone = [](const std::string& file) {
        const TemporaryFolder own;
        return refusal(own.write("a.dcm", file));
    };
    CHECK(contains(alone(colors.file()), "Photometric Interpretation is \"RGB\"; expected MONOCHROME1 or MONOCHROME2"));
    CHECK(contains(alone(report.file()), "is a DICOM file without Pixel Data; expected an image"));
    CHECK(contains(alone(slice_of(0).number(0x00280100, 12).file()), "Bits Allocated is 12; expected 8, 16 or 32"));
    CHECK(contains(alone(slice_of(0).number(0x00280101, 17).file()), "Bits Stored is 17; expected"));
    CHECK(contains(alone(slice_of(0).number(0x00280010, 0).file()), "Rows or Columns is missing or 0; expected"));
    CHECK(contains(alone(slice_of(0).text(0x00280008, "IS", "-1").file()), "Number of Frames is \"-1\"; expected"));
    CHECK(contains(alone(slice_of(0).text(0x00280008, "IS", "9999999999").file()), "Number of Frames is "));
    Dicom deflated = slice_of(0);
    deflated.transfer_syntax = "1.2.840.10008.1.2.1.99";
    CHECK(contains(alone(deflated.file()), "transfer syntax is 1.2.840.10008.1.2.1.99, which compresses the header"));
}

TEST_CASE("hostile lengths in a DICOM file are refused at once, before GDCM takes memory for them")
{
    const TemporaryFolder folder;
    const Effort effort;
    const auto with = [&](uint32_t tag, const std::string& bytes) {
        // Between its predecessor and its successor in tag order.
        Dicom before = slice_of(0);
        Dicom after = before;
        std::erase_if(before.elements, [&](const auto& element) { return element.first >= tag; });
        std::erase_if(after.elements, [&](const auto& element) { return element.first < tag || element.first == tag; });
        return refusal(folder.write("a.dcm", before.file() + bytes + after.data_set()));
    };
    for (const uint32_t length : {0xfffffffeu, 0x7fffffffu, 0x10000000u}) {
        CHECK(
            contains(with(0x00180001, little(0x0018, 2) + little(1, 2) + std::string("UN\0\0", 4) + little(length, 4)),
                     sentence("has length ", length, "; expected at most ")));
        CHECK(contains(
            with(0x00180001, little(0x0018, 2) + little(1, 2) + std::string("SQ\0\0", 4) + little(16, 4) +
                                 little(0xfffe, 2) + little(0xe000, 2) + little(length, 4) + std::string(8, 'x')),
            sentence("has length ", length, "; expected at most ")));
        CHECK(contains(with(PIXELS, little(0x7fe0, 2) + little(0x10, 2) + std::string("OW\0\0", 4) + little(length, 4)),
                       sentence("has length ", length, "; expected at most 0")));
    }
    std::string nested;
    for (int i = 0; i < 10000; ++i) {
        nested += little(0x0018, 2) + little(1, 2) + std::string("SQ\0\0", 4) + little(0xffffffff, 4) +
                  little(0xfffe, 2) + little(0xe000, 2) + little(0xffffffff, 4);
    }
    CHECK(contains(with(0x00180001, nested), "nests sequences more than 16 levels deep"));
    CHECK(contains(with(0x00180001, little(0x0018, 2) + little(1, 2) + std::string("\1\2\0\0", 4)),
                   "has no value representation"));
    CHECK(contains(with(0x00180001, little(0x0018, 2) + little(1, 2) + std::string("UY\1\0", 4)),
                   "has the value representation \"UY\"; expected one that DICOM defines"));
    CHECK(
        contains(refusal(folder.write("a.dcm", slice_of(0).number(0x00280010, 65535).number(0x00280011, 65535).file())),
                 "Pixel Data holds 40 bytes; expected 8589672450 for 1 slices of 65535x65535 pixels of int16"));
    Dicom packed = slice_of(0);
    packed.number(0x00280010, 65535).number(0x00280011, 65535).transfer_syntax = "1.2.840.10008.1.2.4.90";
    packed.elements.erase(PIXELS);
    const std::string fragments = little(0x7fe0, 2) + little(0x10, 2) + std::string("OB\0\0", 4) +
                                  little(0xffffffff, 4) + little(0xfffe, 2) + little(0xe000, 2) + little(0, 4) +
                                  little(0xfffe, 2) + little(0xe000, 2) + little(8, 4) + std::string(8, 'x') +
                                  little(0xfffe, 2) + little(0xe0dd, 2) + little(0, 4);
    CHECK(contains(refusal(folder.write("a.dcm", packed.file() + fragments)),
                   "Pixel Data holds 8 compressed bytes; expected enough for 65535x65535 pixels"));
    CHECK(effort.is_below(AT_ONCE_BYTES));
}

TEST_CASE("damaged DICOM slices are errors, and nothing is written to standard error about them")
{
    const TemporaryFolder folder;
    const fs::path said = folder.path / "said";
    const int kept = ::dup(2);
    const int file = ::open(said.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    REQUIRE(::dup2(file, 2) == 2);
    ::close(file);
    std::vector<std::string> errors;
    for (const char* syntax : {"1.2.840.10008.1.2.4.50", "1.2.840.10008.1.2.4.70", "1.2.840.10008.1.2.4.80",
                               "1.2.840.10008.1.2.4.90", "1.2.840.10008.1.2.5", "1.2.3.4"}) {
        Dicom slice = slice_of(0);
        slice.transfer_syntax = syntax;
        slice.elements.erase(PIXELS);
        const std::string bytes = slice.file() + little(0x7fe0, 2) + little(0x10, 2) + std::string("OB\0\0", 4) +
                                  little(0xffffffff, 4) + little(0xfffe, 2) + little(0xe000, 2) + little(0, 4) +
                                  little(0xfffe, 2) + little(0xe000, 2) + little(64, 4) + std::string(64, 'x') +
                                  little(0xfffe, 2) + little(0xe0dd, 2) + little(0, 4);
        errors.push_back(refusal(folder.write("a.dcm", bytes)));
    }
    const std::string whole = slice_of(0).file();
    for (size_t length = 132; length < whole.size(); length += 7) {
        errors.push_back(refusal(folder.write("a.dcm", whole.substr(0, length))));
    }
    ::dup2(kept, 2);
    ::close(kept);
    for (const std::string& error : errors) CHECK(contains(error, "; expected "));
    std::ifstream read(said);
    CHECK(std::string(std::istreambuf_iterator<char>(read), {}) == "");
}

/// The error for a slice whose only picture is coded as the transfer syntax says.
std::string refusal_of_coded(const TemporaryFolder& folder, const std::string& transfer_syntax,
                             const std::string& picture)
{
    Dicom slice = slice_of(0);
    slice.transfer_syntax = transfer_syntax;
    slice.elements.erase(PIXELS);
    const auto item = [](int element, const std::string& bytes) {
        return little(0xfffe, 2) + little(element, 2) + little(bytes.size(), 4) + bytes;
    };
    return refusal(folder.write("a.dcm", slice.file() + little(0x7fe0, 2) + little(0x10, 2) + std::string("OB\0\0", 4) +
                                             little(0xffffffff, 4) + item(0xe000, "") + item(0xe000, picture) +
                                             item(0xe0dd, "")));
}

TEST_CASE("run-length encoded pictures whose header GDCM would read beyond are refused in words")
{
    const TemporaryFolder folder;
    const auto coded = [&](const std::vector<uint32_t>& header, const std::string& segments) {
        std::string picture;
        for (size_t i = 0; i < 16; ++i) picture += little(i < header.size() ? header[i] : 0, 4);
        return refusal_of_coded(folder, "1.2.840.10008.1.2.5", picture + segments);
    };
    const std::string run("\xed\0\xed\1", 4);  // of 20 pixels, the high bytes and the low ones
    CHECK(contains(coded({0x003e0002, 64, 66}, run), "has 4063234 segments; expected 2, one for each byte of a pixel"));
    CHECK(contains(coded({0, 64, 66}, run), "has 0 segments; expected 2"));
    CHECK(contains(coded({1, 64}, run), "has 1 segments; expected 2"));
    CHECK(contains(coded({2, 60, 66}, run), "segment 1 of a run-length encoded picture begins at byte 60"));
    CHECK(contains(coded({2, 64, 62}, run), "begins at byte 62 of it; expected 64 to 68"));
    CHECK(contains(coded({2, 64, 0xfffffff0}, run), "begins at byte 4294967280 of it; expected 64 to 68"));
    CHECK(contains(refusal_of_coded(folder, "1.2.840.10008.1.2.5", "short."), "has 6 bytes; expected a header of 64"));
}

TEST_CASE("what GDCM's decoders would end the program at is refused in words")
{
    const TemporaryFolder folder;
    const auto encapsulated = [&](const std::string& picture) {
        return refusal_of_coded(folder, "1.2.840.10008.1.2.4.70", picture);
    };
    const Dicom plain = slice_of(0);
    const auto big = [](int number) { return std::string{char(number >> 8), char(number & 255)}; };
    const auto frame = [&](int marker, int bits, int columns, int components) {
        std::string text = {'\xff', char(marker)};
        text += big(8 + 3 * components) + char(bits) + big(4) + big(columns) + char(components);
        for (int i = 0; i < components; ++i) text += std::string{char(i + 1), '\x11', '\0'};
        return text;
    };
    const std::string start = "\xff\xd8", scan = std::string("\xff\xda\0\x08\x01\x01\0\x01\0\0", 10);
    const std::string good = frame(0xc3, 16, 5, 1);
    CHECK(contains(encapsulated("xxxx"), "begins no JPEG picture; expected one"));
    CHECK(contains(encapsulated(start + "xx" + good + scan), "has no marker at byte"));
    CHECK(contains(encapsulated(start + "\xff\xd9"), "ends before its pixels"));
    CHECK(contains(encapsulated(start + good + "\xff\xd9"), "ends before its pixels"));
    CHECK(contains(encapsulated(start + scan), "has no frame before its pixels"));
    CHECK(contains(encapsulated(start + good.substr(0, 8)), "has a segment with a wrong length"));
    CHECK(contains(encapsulated(start + std::string("\xff\xc3\0\x04\x08\0", 6) + scan), "wrong length"));
    CHECK(contains(encapsulated(start + std::string("\xff\xe0\0\x10JFIF\0\x02\0\0\0\x01\0\x01\0\0", 18) + good + scan),
                   "unknown version of JFIF"));
    CHECK(contains(encapsulated(start + frame(0xc2, 16, 5, 1) + scan), "unknown kind or depth"));
    CHECK(contains(encapsulated(start + frame(0xc5, 8, 5, 1) + scan), "unknown kind or depth"));
    CHECK(contains(encapsulated(start + frame(0xc3, 16, 5, 3) + scan), "5x4 pixels of 3 components; expected 5x4"));
    CHECK(contains(encapsulated(start + frame(0xc3, 16, 6, 1) + scan), "6x4 pixels of 1 components; expected 5x4"));
    // Pictures that pass are handed to GDCM, which has no pixels to decode here.
    CHECK(contains(
        encapsulated(start + std::string("\xff\xff\xe0\0\x10JFIF\0\x01\x02\0\0\x01\0\x01\0\0", 19) + good + scan),
        "slice 1 cannot be decoded"));
}

TEST_CASE("what else a DICOM file holds does not matter to its pixels, however odd")
{
    const TemporaryFolder folder;
    const std::vector<int16_t> expected = voxels_of<int16_t>(*open_volume(folder.write("a.dcm", slice_of(0).file())));
    const auto check = [&](const Dicom& slice) {
        CHECK(voxels_of<int16_t>(*open_volume(folder.write("a.dcm", slice.file()))) == expected);
    };
    const auto with = [&](uint32_t tag, const char* type, const std::string& bytes) {
        Dicom slice = slice_of(0);
        slice.elements[tag] = {type, bytes};
        return slice;
    };
    check(with(0x00280004, "CS", "MONOCHROME2\t"));
    check(with(0x00080010, "SH", "1.2.3.1 "));            // a recognition code, as before DICOM
    check(with(0x00080010, "SH", "ACRNEMA_LIBIDO_1.1"));  // of files whose rows are columns
    check(with(0x00280006, "US", ""));                    // how samples of several colours lie
    check(with(0x00280120, "SQ", ""));
    check(with(0x60010010, "US", "\1\0"));  // overlays: private, of another type, with bits of the pixels
    check(with(0x60000010, "LO", "four"));
    check(with(0x60000100, "US", std::string("\1\0", 2)));
    check(with(0x50000005, "US", ""));  // curves
    check(with(0x00880200, "SQ", ""));  // an icon
    for (const bool by_modality : {false, true}) {
        Dicom slice = slice_of(0);
        if (by_modality)
            slice.text(0x00080060, "CS", "MR");
        else
            slice.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.4");
        slice.text(INTERCEPT, "DS", "-1024");  // without a slope
        const auto shifted = open_volume(folder.write("a.dcm", slice.file()));
        CHECK(voxels_of<int32_t>(*shifted)[0] == expected[0] - 1024);
    }
}

TEST_CASE("of the bits of a DICOM pixel only those that are stored count, with their sign")
{
    const TemporaryFolder folder;
    const auto first_of = [&](int bits, int high, bool is_signed, uint16_t number) {
        Dicom slice = slice_of(0);
        slice.number(0x00280101, uint16_t(bits)).number(0x00280102, uint16_t(high));
        slice.number(0x00280103, uint16_t(is_signed));
        slice.elements[PIXELS].bytes.replace(0, 2, little(number, 2));
        const auto source = open_volume(folder.write("a.dcm", slice.file()));
        return is_signed ? int(voxels_of<int16_t>(*source)[0]) : int(voxels_of<uint16_t>(*source)[0]);
    };
    CHECK(first_of(12, 11, false, 0xf123) == 0x123);
    CHECK(first_of(12, 11, true, 0x0fff) == -1);
    CHECK(first_of(12, 11, true, 0x7801) == -0x7ff);
    CHECK(first_of(12, 15, false, 0x123f) == 0x123);
    CHECK(first_of(12, 13, true, 0xfffc) == -1);
    CHECK(first_of(16, 15, true, 0x8000) == -0x8000);
    Dicom slice = slice_of(0);
    slice.number(0x00280102, 16);
    CHECK(contains(refusal(folder.write("a.dcm", slice.file())), "High Bit is 16; expected 15, to Bits Allocated - 1"));
}

TEST_CASE("coded frames of a DICOM file are its fragments, one each")
{
    const TemporaryFolder folder;
    const auto item = [](int element, const std::string& bytes) {
        return little(0xfffe, 2) + little(element, 2) + little(bytes.size(), 4) + bytes;
    };
    const auto picture = [](char value) {  // 20 pixels, run-length encoded: the high bytes and the low ones
        std::string bytes = little(2, 4) + little(64, 4) + little(66, 4) + std::string(52, '\0');
        return bytes + std::string("\xed\0\xed", 3) + value;
    };
    const auto file = [&](const char* frames) {
        Dicom dicom = image_of(0);
        dicom.transfer_syntax = "1.2.840.10008.1.2.5";
        dicom.text(0x00280008, "IS", frames).elements.erase(PIXELS);
        return dicom.file() + little(0x7fe0, 2) + little(0x10, 2) + std::string("OB\0\0", 4) + little(0xffffffff, 4) +
               item(0xe000, "") + item(0xe000, picture(3)) + item(0xe000, picture(4)) + item(0xe0dd, "");
    };
    const std::vector<int16_t> voxels = voxels_of<int16_t>(*open_volume(folder.write("a.dcm", file("2"))));
    CHECK(voxels == [] {
        std::vector<int16_t> expected(20, 3);
        expected.resize(40, 4);
        return expected;
    }());
    CHECK(contains(refusal(folder.write("a.dcm", file("3"))),
                   "Pixel Data has 2 fragments; expected 3, one for each frame"));
}

TEST_CASE("boxes of a DICOM volume come from any thread")
{
    const TemporaryFolder folder;
    folder_of(folder, phantom_slices());
    const auto source = open_volume(folder.path);
    size_t wrong[3] = {};
    {
        std::vector<std::jthread> threads;
        for (size_t t = 0; t < 3; ++t) {
            threads.emplace_back([&, t] {
                for (int i = 0; i < 200; ++i) {
                    const Size3 lower((i + t) % 5, i % 4, (i + 2 * t) % 3);
                    wrong[t] += voxels_in<int16_t>(*source, {lower, lower + int64_t{1}})[0] !=
                                phantom(lower.x, lower.y, lower.z);
                }
            });
        }
    }
    CHECK(wrong[0] + wrong[1] + wrong[2] == 0);
}
