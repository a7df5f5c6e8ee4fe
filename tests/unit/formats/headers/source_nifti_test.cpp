#include <chrono>
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "engine/formats/rescaled.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

constexpr const char* FILES[] = {"sform.nii", "big.nii",          "gzip.nii.gz",  "radiological.nii", "qform.nii",
                                 "pair.hdr",  "pair_gzip.hdr.gz", "version2.nii", "version2_big.nii"};

/// The little-endian phantom of NIfTI-1, for tests to damage.
class Nifti {
public:
    Nifti() : bytes(bytes_of_file(CHIRALITY / "sform.nii")) {}

    template <class T>
    Nifti& set(size_t offset, std::initializer_list<T> values)
    {
        for (const T value : values) {
            std::memcpy(bytes.data() + offset, &value, sizeof(T));
            offset += sizeof(T);
        }
        return *this;
    }
    Nifti& dim(std::initializer_list<int16_t> values) { return set<int16_t>(40, values); }
    Nifti& datatype(int16_t code) { return set<int16_t>(70, {code}); }
    Nifti& pixdim(std::initializer_list<float> values) { return set<float>(80, values); }
    Nifti& voxels_at(float offset) { return set<float>(108, {offset}); }
    Nifti& scale(float slope, float intercept) { return set<float>(112, {slope, intercept}); }
    Nifti& units(char code) { return set<char>(123, {code}); }
    Nifti& codes(int16_t qform, int16_t sform) { return set<int16_t>(252, {qform, sform}); }
    Nifti& rows(std::initializer_list<float> numbers) { return set<float>(280, numbers); }
    Nifti& voxels(const std::string& content)
    {
        bytes = bytes.substr(0, 352) + content;
        return *this;
    }
    std::unique_ptr<VolumeSource> open(const OpenOptions& options = {}) const
    {
        return open_volume(folder.write("a.nii", bytes), options);
    }
    std::string refusal(const OpenOptions& options = {}) const
    {
        return error_of([&] { open(options); });
    }

    TemporaryFolder folder;
    std::string bytes;
};

}  // namespace

TEST_CASE("no form of NIfTI mirrors the chirality phantom, or loses where it lies")
{
    for (const char* name : FILES) {
        CAPTURE(name);
        const auto source = open_volume(CHIRALITY / name);
        CHECK(is_chirality_phantom(*source));
        CHECK(source->info().format == "nifti");
        CHECK(source->info().frame == "RAS");
        CHECK(source->info().unit == "mm");
        for (int axis = 0; axis < 3; ++axis) {
            CHECK(source->info().spacing[axis] == doctest::Approx(glm::dvec3(0.5, 0.5, 1.25)[axis]));
            CHECK(source->info().origin[axis] == doctest::Approx(glm::dvec3(10, 20, 30)[axis]));
            CHECK(source->info().directions[axis][axis] == doctest::Approx(1.0));
        }
        const bool is_turned = std::string_view(name) == "radiological.nii" || std::string_view(name) == "qform.nii";
        CHECK(source->info().warnings.size() == (is_turned ? 1 : 0));
        CHECK(warns_of(*source, "in reverse order along x") == is_turned);
    }
    CHECK(is_chirality_phantom(*open_volume(CHIRALITY / "pair.img")));
    CHECK(is_chirality_phantom(*open_volume(CHIRALITY / "pair_gzip.img.gz")));
}

TEST_CASE("a NIfTI cut anywhere is an error, or still says the same")
{
    std::vector<std::string> names(std::begin(FILES), std::end(FILES));
    names.insert(names.end(), {"pair.img", "pair_gzip.img.gz"});
    for (const std::string& name : names) {
        CAPTURE(name);
        const TemporaryFolder folder;
        fs::copy(CHIRALITY, folder.path);
        const std::string whole = bytes_of_file(CHIRALITY / name);
        for (size_t length = 0; length < whole.size(); ++length) {
            const fs::path path = folder.write(name, whole.substr(0, length));
            try {
                const auto source = open_volume(path);
                const bool is_same = is_chirality_phantom(*source);
                CAPTURE(length);
                CHECK(is_same);
            } catch (const Error& error) {
                CHECK((contains(error.what(), "; expected ") || contains(error.what(), ": cannot be opened: ")));
            }
        }
    }
}

TEST_CASE("hostile numbers in a NIfTI header are refused by field, at once")
{
    const Effort effort;
    CHECK(contains(Nifti().dim({3, 32767, 32767, 32767}).refusal(), "holds 472 bytes; expected at least"));
    CHECK(contains(Nifti().dim({3, -25536, 4, 3}).refusal(),
                   "dim[1] is -25536; expected 1 to 32767: longer sides need NIfTI-2"));
    CHECK(contains(Nifti().dim({3, 5, 0, 3}).refusal(), "dim[2] is 0; expected 1 to 32767"));
    CHECK(contains(Nifti().dim({0, 5, 4, 3}).refusal(), "dim[0] is 0; expected 1 to 7 axes"));
    CHECK(contains(Nifti().dim({-3, 5, 4, 3}).refusal(), "dim[0] is -3; expected 1 to 7 axes"));
    CHECK(contains(Nifti().dim({7, 5, 4, 3, 1, 1, 2, 1}).refusal(), "dim[6] is 2; expected 1"));
    CHECK(contains(Nifti().dim({5, 32767, 32767, 32767, 32767, 32767}).refusal({.channel = "1", .frame = "1"}),
                   "dim states voxels of more than 2^62 bytes"));
    CHECK(contains(Nifti().datatype(1536).refusal(), "datatype is 1536, which is float128; expected"));
    CHECK(contains(Nifti().datatype(32).refusal(), "datatype is 32, which is complex64; expected"));
    CHECK(contains(Nifti().datatype(-7).refusal(), "datatype is -7, which is no type known here; expected"));
    for (const float offset : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -352.0f,
                               4.0f, 352.5f, 1e30f}) {
        CHECK(contains(Nifti().voxels_at(offset).refusal(), "vox_offset is "));
    }
    CHECK(contains(Nifti().voxels_at(1e9f).refusal(), "holds 472 bytes; expected at least 1000000120"));
    CHECK(is_chirality_phantom(*Nifti().voxels_at(0.0f).open()));
    CHECK(effort.is_below(AT_ONCE_BYTES));

    const TemporaryFolder folder;
    CHECK(contains(error_of([&] { open_volume(folder.write("a.nii", "what?")); }),
                   "does not begin with a NIfTI header; expected one of 348 bytes"));
    std::string analyze = bytes_of_file(CHIRALITY / "pair.hdr");
    analyze.replace(344, 4, 4, '\0');
    CHECK(contains(error_of([&] { open_volume(folder.write("a.hdr", analyze)); }), "is in the format Analyze 7.5"));
    folder.write("b.hdr", bytes_of_file(CHIRALITY / "pair.hdr"));
    CHECK(contains(error_of([&] { open_volume(folder.path / "b.hdr"); }), "b.img: cannot be opened: No such file"));
}

TEST_CASE("stored numbers of a NIfTI come out as the intensities that they mean")
{
    const auto floats = Nifti().scale(2.5f, -10.0f).open();
    CHECK(floats->info().type == VoxelType::float32);
    CHECK(warns_of(*floats, "intensities are 2.5 times what is stored, plus -10; int16 became float32"));
    CHECK(voxels_in<float>(*floats, {{1, 2, 1}, {3, 3, 2}}) == std::vector<float>{2.5f * 22 - 10, 2.5f * 23 - 10});
    const auto whole = Nifti().scale(1.0f, 1000.0f).open();
    CHECK(whole->info().type == VoxelType::int32);  // int16 may hold 32767
    CHECK(voxels_in<int32_t>(*whole, {{1, 2, 1}, {3, 3, 2}}) == std::vector<int32_t>{1022, 1023});
    CHECK(Nifti().scale(0.0f, 5.0f).open()->info().type == VoxelType::int16);
    CHECK(Nifti().scale(1.0f, 0.0f).open()->info().warnings.empty());
    const auto unknown = Nifti().scale(std::numeric_limits<float>::quiet_NaN(), 0.0f).open();
    CHECK(unknown->info().type == VoxelType::int16);
    CHECK(warns_of(*unknown, "scl_slope is nan"));
}

TEST_CASE("the type of rescaled voxels holds every intensity that can be stored")
{
    CHECK(rescaled_type(VoxelType::uint16, {1.0, -1024.0, ValueRange{0.0, 4095.0}}) == VoxelType::int16);
    CHECK(rescaled_type(VoxelType::uint16, {1.0, -1024.0}) == VoxelType::int32);
    CHECK(rescaled_type(VoxelType::uint8, {1.0, 1.0}) == VoxelType::uint16);
    CHECK(rescaled_type(VoxelType::uint8, {1.0, -128.0}) == VoxelType::int8);
    CHECK(rescaled_type(VoxelType::int32, {1.0, 1.0}) == VoxelType::float64);
    CHECK(rescaled_type(VoxelType::int16, {1.0, 0.5}) == VoxelType::float32);
    CHECK(rescaled_type(VoxelType::uint32, {0.1, 0.0}) == VoxelType::float64);
    CHECK(rescaled_type(VoxelType::float64, {2.0, 0.0}) == VoxelType::float64);
    CHECK(rescaled_type(VoxelType::int32, {1.0, 0.0}) == VoxelType::int32);

    std::vector<uint8_t> stored(3000);
    for (size_t i = 0; i < stored.size(); ++i) stored[i] = uint8_t(i * 7);
    const auto source = rescaled(std::make_unique<MemorySource>(memory_source({3000, 1, 1}, VoxelType::uint8, stored)),
                                 {.slope = 0.5, .intercept = 1.0});
    const std::vector<float> found = voxels_of<float>(*source);
    size_t wrong = 0;
    for (size_t i = 0; i < stored.size(); ++i) wrong += found[i] != 0.5f * float(stored[i]) + 1.0f;
    CHECK(wrong == 0);
}

TEST_CASE("spacing, unit and axes of a NIfTI are those it states, and what it leaves open is said")
{
    CHECK(Nifti().units(3).open()->info().unit == "um");
    CHECK(Nifti().units(1).open()->info().unit == "m");
    CHECK(warns_of(*Nifti().units(0).open(), "spacing is stated without a unit; mm assumed"));
    CHECK(Nifti().units(2 + 8).open()->info().unit == "mm");  // 8: seconds

    const auto bare = Nifti().codes(0, 0).open();
    CHECK(bare->info().frame.empty());
    CHECK(bare->info().spacing == glm::dvec3(0.5, 0.5, 1.25));
    const auto odd = Nifti().codes(0, 0).pixdim({-2.0f, 0.0f, std::numeric_limits<float>::quiet_NaN()}).open();
    CHECK(odd->info().spacing == glm::dvec3(2, 1, 1));
    CHECK(warns_of(*odd, "pixdim[1] is -2; spacing 2 along x assumed"));
    CHECK(warns_of(*odd, "pixdim[2] is 0; spacing 1 along y assumed"));
    CHECK(warns_of(*odd, "pixdim[3] is nan; spacing 1 along z assumed"));
    CHECK(warns_of(*Nifti().codes(0, 0).pixdim({0, 0, 0}).open(), "no spacing stated"));
    CHECK(warns_of(*Nifti().pixdim({9, 0.5f, 1.25f}).open(), "spacing along x is 0.5 by the sform and 9 by pixdim"));

    const auto flat = Nifti().rows({1, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0}).open();
    CHECK(warns_of(*flat, "sform and qform are singular"));
    CHECK(is_chirality_phantom(*flat));
    const auto oblique = Nifti().rows({0.5f, 0, 0, 1, 0, 0.4f, -0.75f, 2, 0, 0.3f, 1.0f, 3}).open();
    CHECK(oblique->info().spacing.z == doctest::Approx(1.25));
    CHECK(warns_of(*oblique, "axes are turned by up to 36.9 degrees against those of the scanner (RAS)"));
    CHECK(is_chirality_phantom(*oblique));
}

TEST_CASE("one time point, component or colour of a NIfTI is chosen in words")
{
    std::string bytes;
    for (int i = 0; i < 180; ++i) bytes += char(i);
    const auto second = [](const VolumeSource& source) { return voxels_of<uint8_t>(source)[1]; };
    Nifti moving;
    moving.datatype(2).dim({4, 5, 4, 3, 3}).voxels(bytes);
    CHECK(contains(moving.refusal(), "holds 3 time points; expected frame to choose one: 1 to 3"));
    CHECK(second(*moving.open({.frame = "3"})) == 121);
    CHECK(contains(moving.refusal({.frame = "0"}), "frame is \"0\"; expected 1 to 3"));
    Nifti vector;
    vector.datatype(2).dim({5, 5, 4, 3, 1, 3}).voxels(bytes);
    CHECK(contains(vector.refusal(), "holds 3 channels; expected channel to choose one: 1 to 3"));
    CHECK(second(*vector.open({.channel = "2"})) == 61);
    Nifti colors;
    colors.datatype(128).scale(3, 3).voxels(bytes);
    CHECK(contains(colors.refusal(), "expected channel to choose one: 1 to 3, red, green, blue"));
    CHECK(second(*colors.open({.channel = "blue"})) == 5);
    CHECK(colors.open({.channel = "red"})->info().warnings.empty());
}
