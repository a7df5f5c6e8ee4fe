// Integers of 64 bits, bool and floats of 16 bits in Zarr, NIfTI, TIFF, NRRD and MetaImage.

#include "engine/formats/stored_numbers.h"

#include <bit>
#include <cmath>

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "tests/support/tiff_files.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

template <class Value>
std::string bytes_of_all(const std::vector<Value>& values)
{
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

/// Four voxels in a row, in an uncompressed Zarr array of version 2 (`dtype`) or 3; a second chunk of four is missing.
fs::path zarr_of(const TemporaryFolder& folder, int version, const std::string& type, const std::string& fill,
                 const std::string& bytes)
{
    const fs::path array = folder.path / sentence("v", version, ".zarr");
    fs::remove_all(array);
    fs::create_directories(array / (version == 3 ? "c/0/0" : "."));
    const auto write = [&](const char* name, const std::string& text) {
        std::ofstream(array / name, std::ios::binary) << text;
    };
    if (version == 2) {
        write(".zarray", R"({"zarr_format": 2, "shape": [1, 1, 8], "chunks": [1, 1, 4], "dtype": ")" + type +
                             R"(", "compressor": null, "fill_value": )" + fill + R"(, "order": "C", "filters": null})");
        write("0.0.0", bytes);
    } else {
        write("zarr.json", R"({"zarr_format": 3, "node_type": "array", "shape": [1, 1, 8], "data_type": ")" + type +
                               R"(", "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [1, 1, 4]}}, )"
                               R"("chunk_key_encoding": {"name": "default"}, "fill_value": )" +
                               fill + R"(, "codecs": [{"name": "bytes", "configuration": {"endian": "little"}}]})");
        write("c/0/0/0", bytes);
    }
    return array;
}

std::vector<double> doubles_of(const VolumeSource& source)
{
    const Size3 size = source.info().size;
    std::vector<double> values(size_t(size.x * size.y * size.z));
    if (source.info().type == VoxelType::float64) {
        source.read({Size3(0), size}, std::as_writable_bytes(std::span(values)));
    } else if (source.info().type == VoxelType::float32) {
        std::vector<float> floats(values.size());
        source.read({Size3(0), size}, std::as_writable_bytes(std::span(floats)));
        values.assign(floats.begin(), floats.end());
    } else {
        REQUIRE(source.info().type == VoxelType::uint8);
        std::vector<uint8_t> bytes(values.size());
        source.read({Size3(0), size}, std::as_writable_bytes(std::span(bytes)));
        values.assign(bytes.begin(), bytes.end());
    }
    return values;
}

constexpr int64_t LARGEST = int64_t{1} << 53;

}  // namespace

TEST_CASE("floats of 16 bits are converted both ways")
{
    for (int bits = 0; bits < 0x10000; ++bits) {
        const float value = float_of_half(uint16_t(bits));
        if (std::isnan(value)) continue;
        if (half_of(double(value)) != uint16_t(bits)) FAIL_CHECK(bits);
    }
    CHECK(half_of(1.0) == 0x3c00);
    CHECK(float_of_half(0x3555) == doctest::Approx(1.0 / 3.0).epsilon(1e-3));
    CHECK_FALSE(half_of(65520.0));
    CHECK(half_of(65519.0) == 0x7bff);
    CHECK(std::isnan(float_of_half(*half_of(NAN))));
}

// Kind (Types): int64, uint64, bool and float16
TEST_CASE("Zarr arrays of int64, uint64, bool and float16 are read exactly")
{
    const TemporaryFolder folder;
    const std::vector<int64_t> whole{-3, 0, LARGEST, -LARGEST};
    const std::vector<double> as_doubles{-3.0, 0.0, double(LARGEST), -double(LARGEST), 7.0, 7.0, 7.0, 7.0};
    for (const int version : {2, 3}) {
        CAPTURE(version);
        const auto open = [&](const char* code, const char* name, const std::string& fill, const std::string& bytes) {
            return open_volume(zarr_of(folder, version, version == 2 ? code : name, fill, bytes));
        };
        const auto integers = open("<i8", "int64", "7", bytes_of_all(whole));
        CHECK(integers->info().type == VoxelType::float64);
        CHECK(warns_of(*integers, "its int64 values are read as float64"));
        CHECK(doubles_of(*integers) == as_doubles);
        const auto stored = integers->stored_blocks(0, 100);
        REQUIRE(stored);
        CHECK(stored->fill == 7.0);
        CHECK(stored->blocks.size() == 1);
        const auto unsigned_ones = open("<u8", "uint64", "0", bytes_of_all(std::vector<uint64_t>{1, 2, 3, 1 << 30}));
        CHECK(doubles_of(*unsigned_ones) == std::vector<double>{1, 2, 3, 1 << 30, 0, 0, 0, 0});
        const auto flags = open("|b1", "bool", "true", bytes_of_all(std::vector<uint8_t>{0, 1, 1, 0}));
        CHECK(doubles_of(*flags) == std::vector<double>{0, 1, 1, 0, 1, 1, 1, 1});
        const auto halves =
            open("<f2", "float16", "0.5", bytes_of_all(std::vector<uint16_t>{0x3c00, 0xc000, 0, 0x7bff}));
        CHECK(halves->info().type == VoxelType::float32);
        CHECK(doubles_of(*halves) == std::vector<double>{1, -2, 0, 65504, 0.5, 0.5, 0.5, 0.5});
        const auto large = open("<i8", "int64", "0", bytes_of_all(std::vector<int64_t>{1, LARGEST + 1, 0, 0}));
        CHECK(contains(error_of([&] { doubles_of(*large); }),
                       "holds 9007199254740993 as int64; expected at most 9007199254740992, with either sign"));
        CHECK(
            contains(error_of([&] { open("<f2", "float16", "1e6", "12345678"); }), "a number that 16-bit floats hold"));
    }
    const std::string turned("\0\0\0\0\0\0\0\x05", 8);
    const auto big = open_volume(zarr_of(folder, 2, ">i8", "0", turned + turned + turned + turned));
    CHECK(doubles_of(*big) == std::vector<double>{5, 5, 5, 5, 0, 0, 0, 0});
}

TEST_CASE("NIfTI and TIFF of int64 and uint64 are read exactly")
{
    const TemporaryFolder folder;
    std::string header(352, '\0');
    const auto put = [&](size_t at, auto value) { std::memcpy(header.data() + at, &value, sizeof(value)); };
    put(0, int32_t{348});
    for (size_t i = 0; i < 8; ++i) put(40 + 2 * i, int16_t(i == 0 ? 3 : i == 1 ? 4 : 1));
    put(70, int16_t{1024});
    put(72, int16_t{64});
    for (size_t i = 0; i < 8; ++i) put(76 + 4 * i, 1.0F);
    put(108, 352.0F);
    std::memcpy(header.data() + 344, "n+1", 4);
    const std::vector<int64_t> values{-3, 0, LARGEST, 255};
    const auto nifti = open_volume(folder.write("a.nii", header + bytes_of_all(values)));
    CHECK(doubles_of(*nifti) == std::vector<double>{-3, 0, double(LARGEST), 255});
    put(70, int16_t{1280});
    const auto large = open_volume(folder.write("b.nii", header + bytes_of_all(values)));
    CHECK(contains(error_of([&] { doubles_of(*large); }), "holds 18446744073709551613 as uint64; expected at most"));

    TiffSpec spec{.width = 4, .height = 1, .bits = 64, .format = SAMPLEFORMAT_INT};
    const auto tiff = open_volume(write_tiff(folder.path / "a.tif", spec, {bytes_of_all(values)}));
    CHECK(doubles_of(*tiff) == std::vector<double>{-3, 0, double(LARGEST), 255});
    spec.format = SAMPLEFORMAT_UINT;
    const auto swapped =
        open_volume(write_tiff(folder.path / "b.tif", spec, {bytes_of_all(std::vector<uint64_t>{1, 2, 3, 4})}, "wb"));
    CHECK(doubles_of(*swapped) == std::vector<double>{1, 2, 3, 4});
}

// Kind (Types): int64 and uint64 in NRRD and MetaImage
TEST_CASE("NRRD and MetaImage of int64 and uint64 are read exactly, or refused at the first value that is not exact")
{
    const TemporaryFolder folder;
    const auto nrrd = [&](const std::string& type, const std::string& endian, const std::string& bytes) {
        return open_volume(folder.write("a.nrrd", "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: 4 1 1\nendian: " +
                                                      endian + "\nencoding: raw\n\n" + bytes));
    };
    const auto mha = [&](const std::string& type, const std::string& more, const std::string& bytes) {
        return open_volume(folder.write("a.mha", "ObjectType = Image\nNDims = 3\nDimSize = 4 1 1\nBinaryData = True\n" +
                                                     more + "ElementType = " + type + "\nElementDataFile = LOCAL\n" +
                                                     bytes));
    };
    const std::string whole = bytes_of_all(std::vector<int64_t>{-3, 0, LARGEST, -LARGEST});
    const std::vector<double> as_doubles{-3.0, 0.0, double(LARGEST), -double(LARGEST)};
    const std::string natural = bytes_of_all(std::vector<uint64_t>{0, 255, 65536, uint64_t(LARGEST)});
    const std::vector<double> natural_doubles{0.0, 255.0, 65536.0, double(LARGEST)};
    for (const char* type : {"longlong", "long long int", "signed long long", "int64", "int64_t"}) {
        CAPTURE(type);
        const auto source = nrrd(type, "little", whole);
        CHECK(source->info().type == VoxelType::float64);
        CHECK(warns_of(*source, "its int64 values are read as float64"));
        CHECK(doubles_of(*source) == as_doubles);
    }
    for (const char* type : {"ulonglong", "unsigned long long int", "uint64_t"})
        CHECK(doubles_of(*nrrd(type, "little", natural)) == natural_doubles);
    CHECK(doubles_of(*mha("MET_LONG_LONG", "BinaryDataByteOrderMSB = False\n", whole)) == as_doubles);
    CHECK(doubles_of(*mha("MET_ULONG_LONG", "BinaryDataByteOrderMSB = False\n", natural)) == natural_doubles);

    const std::string swapped("\0\0\0\0\0\0\1\5", 8);
    CHECK(doubles_of(*nrrd("int64", "big", swapped + swapped + swapped + swapped)) ==
          std::vector<double>{261.0, 261.0, 261.0, 261.0});

    // The function of a MetaImage is applied to the values, not to their bits.
    const std::string scaled =
        "BinaryDataByteOrderMSB = False\nElementToIntensityFunctionSlope = 2\nElementToIntensityFunctionOffset = 1\n";
    CHECK(doubles_of(*mha("MET_LONG_LONG", scaled, bytes_of_all(std::vector<int64_t>{-3, 0, 1, 100}))) ==
          std::vector<double>{-5.0, 1.0, 3.0, 201.0});

    const std::string large = bytes_of_all(std::vector<int64_t>{1, 2, LARGEST + 1, 3});
    CHECK(contains(error_of([&] { doubles_of(*nrrd("int64", "little", large)); }),
                   "a.nrrd: holds 9007199254740993 as int64; expected at most 9007199254740992, with either sign"));
    CHECK(contains(error_of([&] { doubles_of(*mha("MET_ULONG_LONG", "BinaryDataByteOrderMSB = False\n", whole)); }),
                   "a.mha: holds 18446744073709551613 as uint64; expected at most 9007199254740992 up to which"));
    CHECK(contains(error_of([&] { nrrd("int64", "little", whole.substr(8)); }), "expected at least"));
}
