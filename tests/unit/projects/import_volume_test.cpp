// Projects: they hold what was imported, are complete or absent, and damage is detected.

#include "engine/projects/import_volume.h"
#include "engine/base/file.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <map>
#include <mutex>
#include <random>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "engine/base/file.h"
#include "engine/formats/open_volume.h"
#include "engine/formats/zarr/project.h"
#include "engine/volume/content_hash.h"
#include "tests/support/slow.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

/// Noise with a corner of zeros.
template <class T>
MemorySource noise(const Size3& size, VoxelType type, uint32_t seed)
{
    std::mt19937 numbers(seed);
    std::vector<T> voxels;
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) {
                const bool is_empty = x < 64 && y < 64 && z >= 64;
                voxels.push_back(is_empty ? T{0} : static_cast<T>(int(numbers() % 3000) - 500));
            }
    MemorySource plain = memory_source<T>(size, type, voxels);
    VolumeInfo info = plain.info();
    info.spacing = {0.5, 0.75, 2.0};
    info.unit = "um";
    info.origin = {10.0, 20.0, 30.0};
    info.frame = "LPS";
    info.warnings = {"a warning of the source"};
    const auto bytes = std::as_bytes(std::span(voxels));
    return {std::move(info), {bytes.begin(), bytes.end()}};
}

/// Fails at the n-th read: with an error, or by requesting to stop.
class Interrupted final : public VolumeSource {
public:
    Interrupted(const VolumeSource& source, int reads, bool fails)
        : VolumeSource(source.info()), source_(source), last_(reads), fails_(fails)
    {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        source_.read(box, voxels);
        const std::scoped_lock lock(mutex_);  // a thread that counts a later read must see `stop`
        if (++reads_ != last_) return;
        if (fails_) fail("source: cannot be read: Input/output error");
        stop = true;
    }
    int reads() const { return reads_; }
    mutable std::atomic<bool> stop = false;

private:
    const VolumeSource& source_;
    int last_;
    mutable std::mutex mutex_;
    mutable std::atomic<int> reads_ = 0;
    bool fails_;
};

std::map<std::string, std::string> content_of(const fs::path& folder)
{
    std::map<std::string, std::string> content;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file()) continue;
        content[fs::relative(entry.path(), folder).string()] = bytes_of_file(entry.path());
    }
    return content;
}

class Folder : public TemporaryFolder {
public:
    ImportReport import(const VolumeSource& source, const std::string& name = "project",
                        ImportOptions options = {}) const
    {
        return import_volume(source, path / "source.raw", path / name, options);
    }
    std::string refusal(const VolumeSource& source, const ImportOptions& options = {}) const
    {
        return error_of([&] { import(source, "project", options); });
    }
};

const Size3 SIZE{70, 66, 200};  // 2 x 2 x 4 chunks

}  // namespace

TEST_CASE("a project holds the voxels of its source, and knows what else can be known of them")
{
    const Folder folder;
    const MemorySource source = noise<int16_t>(SIZE, VoxelType::int16, 1);
    const ImportReport report = folder.import(source);
    CHECK(report.project == folder.path / "project");
    CHECK(report.info.size == SIZE);
    CHECK(report.levels == 4);
    CHECK(report.bricks == 16 + 2 + 1 + 1);
    CHECK(report.bricks_stored == report.bricks - 3);
    CHECK_FALSE(report.was_resumed);
    CHECK_FALSE(fs::exists(folder.path / "project.part"));
    int64_t bytes = 0;
    for (const auto& [name, content] : content_of(folder.path / "project")) bytes += int64_t(content.size());
    CHECK(report.bytes == bytes);

    const auto project = open_volume(folder.path / "project");
    CHECK(project->info().format == "ome-zarr");
    CHECK(project->info().name == "project");
    CHECK(project->info().type == VoxelType::int16);
    CHECK(project->info().spacing == source.info().spacing);
    CHECK(project->info().unit == "um");
    CHECK(project->info().origin == source.info().origin);
    CHECK(project->info().frame == "LPS");
    CHECK(project->info().warnings == source.info().warnings);
    CHECK(voxels_of<int16_t>(*project) == voxels_of<int16_t>(source));
    REQUIRE(project->levels() == 4);
    CHECK(level_of<int16_t>(*project, 3).size() == 9 * 9 * 25);

    const VolumeStatistics expected = measure(source);
    const std::optional<VolumeStatistics> known = project->statistics();
    REQUIRE(known.has_value());
    CHECK(known->minimum == expected.minimum);
    CHECK(known->maximum == expected.maximum);
    CHECK(known->mean == expected.mean);
    CHECK(known->histogram == expected.histogram);
    CHECK(content_hash(*project) == content_hash(source));
    const ProjectRecord record = read_project_record(folder.path / "project" / PROJECT_RECORD);
    CHECK(record.content_hash == content_hash(source));
    CHECK(record.source == (folder.path / "source.raw").string());

    for (int level = 0; level < 4; ++level) {
        const auto range = project->brick_range(level, {1, 1, 0});
        CHECK(range.has_value() == (level < 2));
    }
    CHECK_FALSE(project->brick_range(0, {3, 0, 0}).has_value());
    CHECK_FALSE(project->brick_range(4, {0, 0, 0}).has_value());
    CHECK(project->brick_range(0, {0, 0, 4}).value() == ValueRange{0.0, 0.0});  // far from every other voxel
    CHECK(project->brick_range(3, {0, 0, 0}).value() == ValueRange{expected.minimum, expected.maximum});
}

TEST_CASE("every type becomes a project and comes back, statistics and all")
{
    const auto check = [](auto zero, VoxelType type) {
        using T = decltype(zero);
        CAPTURE(name_of(type));
        const Folder folder;
        const MemorySource source = noise<T>({40, 30, 70}, type, 2);
        folder.import(source);
        const auto project = open_volume(folder.path / "project");
        CHECK(project->info().type == type);
        CHECK(voxels_of<T>(*project) == voxels_of<T>(source));
        const VolumeStatistics expected = measure(source);
        CHECK(project->statistics()->histogram == expected.histogram);
        CHECK(project->statistics()->mean == doctest::Approx(expected.mean).epsilon(1e-12));
        CHECK(project->statistics()->bulk == expected.bulk);
    };
    check(uint8_t{}, VoxelType::uint8);
    check(int8_t{}, VoxelType::int8);
    check(uint16_t{}, VoxelType::uint16);
    check(int16_t{}, VoxelType::int16);
    check(uint32_t{}, VoxelType::uint32);
    check(int32_t{}, VoxelType::int32);
    check(float{}, VoxelType::float32);
    check(double{}, VoxelType::float64);
}

TEST_CASE("NaN, infinities and outliers survive a project, and are told of")
{
    const Folder folder;
    std::vector<float> voxels(50 * 40 * 30);
    for (size_t i = 0; i < voxels.size(); ++i) voxels[i] = float(i % 97);
    voxels[7] = std::numeric_limits<float>::quiet_NaN();
    voxels[99] = std::numeric_limits<float>::infinity();
    folder.import(memory_source<float>({50, 40, 30}, VoxelType::float32, voxels));
    const auto project = open_volume(folder.path / "project");
    CHECK(project->statistics()->not_finite == 2);
    CHECK(project->statistics()->maximum == 96.0);
    const std::vector<float> found = voxels_of<float>(*project);
    CHECK(std::memcmp(found.data(), voxels.data(), voxels.size() * sizeof(float)) == 0);
    CHECK(project->brick_range(0, {0, 0, 0}).value() == ValueRange{0.0, 96.0});
    for (const float voxel : level_of<float>(*project, 1)) REQUIRE(std::isfinite(voxel));
}

TEST_CASE("the number of threads changes no byte of a project")
{
    const Folder folder;
    const MemorySource source = noise<uint16_t>(SIZE, VoxelType::uint16, 3);
    for (const int threads : {1, 2, 7}) {
        folder.import(source, sentence("threads-", threads),
                      {.preparation = {.blur_sigma_voxels = glm::dvec3(0.8)}, .threads = threads});
    }
    auto one = content_of(folder.path / "threads-1");
    for (const char* other : {"threads-2", "threads-7"}) {
        auto content = content_of(folder.path / other);
        // The names of the projects differ.
        CHECK(content.erase(".zattrs") == 1);
        one.erase(".zattrs");
        CHECK(content == one);
    }
}

TEST_CASE("an import that was stopped or failed anywhere goes on, and gives the same bytes")
{
    const Folder folder;
    const MemorySource source = noise<uint16_t>({70, 66, 330}, VoxelType::uint16, 4);
    const ImportOptions options{.preparation = {.blur_sigma_voxels = glm::dvec3(0.6)}, .threads = 2};
    folder.import(source, "project", options);
    const auto expected = content_of(folder.path / "project");
    fs::remove_all(folder.path / "project");
    bool was_ever_resumed = false;
    for (const int reads : {1, 3, 7, 12}) {
        for (const bool fails : {true, false}) {
            // Every day two of them fail, and the other two are stopped.
            if (!is_slow() && fails != (reads == 1 || reads == 7)) continue;
            CAPTURE(reads);
            CAPTURE(fails);
            int runs = 0;
            for (int length = reads;; length += reads) {
                REQUIRE(++runs < 100);
                const Interrupted interrupted(source, length, fails);
                ImportOptions stoppable = options;
                stoppable.cancel = &interrupted.stop;
                try {
                    const ImportReport report = folder.import(interrupted, "project", stoppable);
                    was_ever_resumed = was_ever_resumed || report.was_resumed;
                    break;
                } catch (const ImportStopped& stopped) {
                    CHECK(stopped.what() == (folder.path / "project.part").string() +
                                                ": the import was stopped; what is done is kept, and the same command "
                                                "goes on from there; rm -r removes it");
                } catch (const Error& error) {
                    CHECK(contains(error.what(), "source: cannot be read: Input/output error; what is done is kept"));
                }
                CHECK_FALSE(fs::exists(folder.path / "project"));
            }
            CHECK(content_of(folder.path / "project") == expected);
            fs::remove_all(folder.path / "project");
        }
    }
    CHECK(was_ever_resumed);
}

TEST_CASE("what another import left is not gone on with")
{
    const Folder folder;
    const MemorySource source = noise<uint16_t>({70, 66, 330}, VoxelType::uint16, 5);
    const auto leave_part = [&](const ImportOptions& options) {
        const Interrupted interrupted(source, 5, true);
        CHECK(!folder.refusal(interrupted, options).empty());
        REQUIRE(fs::exists(folder.path / "project.part"));
    };
    const ImportOptions blurred{.preparation = {.blur_sigma_voxels = glm::dvec3(0.5)}};
    leave_part(blurred);
    const ImportReport report = folder.import(source);
    CHECK_FALSE(report.was_resumed);
    REQUIRE(report.warnings.size() == 2);
    CHECK(contains(report.warnings[1],
                   "project.part was started from another file or with other options; the import starts over"));
    CHECK(voxels_of<uint16_t>(*open_volume(folder.path / "project")) == voxels_of<uint16_t>(source));
    fs::remove_all(folder.path / "project");

    leave_part({});
    folder.write("project.part/shvr/import.state", "spoiled");
    CHECK(contains(folder.import(source).warnings.at(1), "is damaged, or of another version"));
    fs::remove_all(folder.path / "project");

    // The source file was written again.
    folder.write("source.raw", "one");
    leave_part({});
    folder.write("source.raw", "another");
    CHECK(contains(folder.import(source).warnings.at(1), "started from another file"));
    fs::remove_all(folder.path / "project");

    fs::create_directory(folder.path / "project.part");
    folder.write("project.part/mine.txt", "keep me");
    CHECK(contains(folder.refusal(source), "project.part: is not the remainder of an import; expected no such folder"));
    CHECK(fs::exists(folder.path / "project.part/mine.txt"));
}

TEST_CASE("what is there is not replaced, unless it is a project and that is wanted")
{
    const Folder folder;
    const MemorySource source = noise<uint8_t>({40, 30, 20}, VoxelType::uint8, 6);
    const MemorySource other = noise<uint8_t>({20, 30, 20}, VoxelType::uint8, 7);
    fs::create_directory(folder.path / "project");
    folder.import(source);  // an empty folder counts as absent
    CHECK(contains(folder.refusal(other), "project: already exists; expected a new name, or --overwrite"));
    const Interrupted broken(other, 1, true);
    CHECK(!folder.refusal(broken, {.overwrites = true}).empty());
    CHECK(open_volume(folder.path / "project")->info().size.x == 40);  // still complete
    folder.import(other, "project/", {.overwrites = true});
    CHECK(voxels_of<uint8_t>(*open_volume(folder.path / "project")) == voxels_of<uint8_t>(other));
    CHECK_FALSE(fs::exists(folder.path / "project.part"));

    fs::remove_all(folder.path / "project");
    fs::create_directory(folder.path / "project");
    folder.write("project/thesis.txt", "keep me");
    CHECK(contains(
        folder.refusal(source, {.overwrites = true}),
        "project: is not a project; expected one, since --overwrite replaces nothing else: choose a new name"));
    fs::remove_all(folder.path / "project");
    folder.write("project", "a file");
    CHECK(contains(folder.refusal(source, {.overwrites = true}), "is not a project"));
    fs::remove(folder.path / "project");
    CHECK(contains(folder.refusal(source, {.preparation = {.crop = VoxelBox{{0, 0, 0}, {41, 30, 20}}}}),
                   "outside the volume"));
    CHECK_FALSE(fs::exists(folder.path / "project.part"));
    CHECK(contains(error_of([&] { folder.import(source, "no/such/folder"); }), "cannot be written: No such file"));
}

TEST_CASE("a project without its knowledge is an image; damaged knowledge is named and not used")
{
    const Folder folder;
    const MemorySource source = noise<uint16_t>({70, 40, 40}, VoxelType::uint16, 8);
    folder.import(source);
    const fs::path root = folder.path / "project";
    const std::vector<uint16_t> expected = voxels_of<uint16_t>(source);
    const auto whole = content_of(root);
    int named = 0;
    for (const auto& [name, content] : whole) {
        if (name == "shvr/session.json" || name == ".zgroup") continue;  // a volume needs neither
        for (size_t part = 0; part < 12; ++part) {
            CAPTURE(name);
            CAPTURE(part);
            folder.write("project/" + name, content.substr(0, content.size() * part / 12));
            std::unique_ptr<VolumeSource> project;
            std::vector<uint16_t> voxels;
            const std::string said = error_of([&] {
                project = open_volume(root);
                voxels = voxels_of<uint16_t>(*project);
                for (int level = 1; level < project->levels(); ++level) level_of<uint16_t>(*project, level);
            });
            if (name.starts_with("shvr/")) {
                CHECK(said.empty());
                CHECK(warns_of(*project, name));
                CHECK(warns_of(*project, "it is not used"));
            }
            if (said.empty()) {
                CHECK(voxels == expected);
                // A level without metadata is left out, and so are those after it.
                if (!name.starts_with("shvr/")) CHECK(project->levels() == name[0] - '0');
            } else {
                CHECK(contains(said, name));
                ++named;
            }
        }
        folder.write("project/" + name, content);
    }
    CHECK(named > 30);
    fs::remove_all(root / "shvr");
    const auto image = open_volume(root);
    CHECK(voxels_of<uint16_t>(*image) == expected);
    CHECK(image->levels() == 3);
    CHECK(image->info().spacing == source.info().spacing);
    CHECK(image->info().unit == "um");
    CHECK(image->info().origin == source.info().origin);
    CHECK(image->info().warnings.empty());
    CHECK_FALSE(image->statistics().has_value());
}

TEST_CASE("a project's record that describes no volume is named and not used")
{
    const Folder folder;
    folder.import(noise<uint16_t>({7, 4, 4}, VoxelType::uint16, 8));
    const fs::path root = folder.path / "project";
    const std::string whole = read_text(root / PROJECT_RECORD, 1 << 20);
    const auto with = [&](const char* key, const nlohmann::json& value) {
        nlohmann::json record = nlohmann::json::parse(whole);
        record[nlohmann::json::json_pointer(key)] = value;
        folder.write(std::string("project/") + PROJECT_RECORD, record.dump());
        return open_volume(root);
    };
    CHECK(warns_of(*with("/directions/0/0", -1), "expected three right-handed vectors of length 1; it is not used"));
    CHECK(warns_of(*with("/directions/2/2", 2), "expected three right-handed vectors of length 1; it is not used"));
    CHECK(warns_of(*with("/spacing/1", 0), "expected three numbers above 0; it is not used"));
    CHECK(warns_of(*with("/statistics/max", -1), "expected at least min; it is not used"));
    CHECK(with("/unit", "u\x1bm")->info().unit == "u?m");
}

TEST_CASE("one wrong bit in a stored chunk is found, the chunk is named, and the rest can be read")
{
    const Folder folder;
    const MemorySource source = noise<uint8_t>({130, 40, 40}, VoxelType::uint8, 9);
    folder.import(source);
    const fs::path chunk = folder.path / "project/0/0/0/1";
    const std::string whole = content_of(folder.path / "project").at("0/0/0/1");
    std::mt19937 numbers(10);
    for (int i = 0; i < 300; ++i) {
        std::string spoiled = whole;
        spoiled[numbers() % whole.size()] ^= char(1 << numbers() % 8);
        folder.write("project/0/0/0/1", spoiled);
        const auto project = open_volume(folder.path / "project");
        REQUIRE(error_of([&] { voxels_of<uint8_t>(*project); }) ==
                chunk.string() + ": is damaged, or another program changed it; expected what the import wrote");
        REQUIRE(voxels_in<uint8_t>(*project, {{0, 0, 0}, {64, 40, 40}}) ==
                voxels_in<uint8_t>(source, {{0, 0, 0}, {64, 40, 40}}));
        REQUIRE(voxels_in<uint8_t>(*project, {{128, 0, 0}, {130, 40, 40}}).size() == 3200);
    }
    fs::remove(chunk);
    CHECK(contains(error_of([&] { voxels_of<uint8_t>(*open_volume(folder.path / "project")); }),
                   "0/0/0/1: is missing; expected the chunk that the import wrote"));
}

TEST_CASE("two imports do not work on one folder at once")
{
    const Folder folder;
    const MemorySource source = noise<uint8_t>({40, 40, 40}, VoxelType::uint8, 11);
    /// Starts a second import while being read.
    class Nested final : public VolumeSource {
    public:
        Nested(const VolumeSource& source, const Folder& folder)
            : VolumeSource(source.info()), source_(source), folder_(folder)
        {}
        void read(const VoxelBox& box, std::span<std::byte> voxels) const override
        {
            if (said.empty()) said = folder_.refusal(source_);
            source_.read(box, voxels);
        }
        mutable std::string said;

    private:
        const VolumeSource& source_;
        const Folder& folder_;
    };
    const Nested nested(source, folder);
    folder.import(nested, "project", {.threads = 1});
    CHECK(contains(nested.said, "project.part: another process is importing into it"));
}

TEST_CASE("an import whose progress is cancelled names the folder from which it goes on")
{
    const Folder folder;
    const MemorySource source = noise<uint16_t>({200, 200, 200}, VoxelType::uint16, 12);
    std::string message;
    try {
        folder.import(source, "project",
                      {.threads = 1, .progress = [](const ImportProgress&) { throw Stopped("cancelled"); }});
    } catch (const ImportStopped& stopped) {
        message = stopped.what();
    }
    CHECK(message == (folder.path / "project.part").string() +
                         ": the import was stopped; what is done is kept, and the same command goes on from there; "
                         "rm -r removes it");
}

TEST_CASE("a caller that offers to resume and to delete gets messages without commands")
{
    const Folder folder;
    const MemorySource source = noise<uint16_t>({200, 200, 200}, VoxelType::uint16, 12);
    const ImportOptions stopped{
        .threads = 1, .progress = [](const ImportProgress&) { throw Stopped("cancelled"); }, .tells_commands = false};
    CHECK(error_of([&] { folder.import(source, "project", stopped); }) ==
          "what is done is kept in " + (folder.path / "project.part").string() + ", and can be resumed or deleted");
    const Interrupted broken(source, 1, true);
    CHECK(error_of([&] { folder.import(broken, "other", {.threads = 1, .tells_commands = false}); }) ==
          "source: cannot be read: Input/output error; what is done is kept in " +
              (folder.path / "other.part").string() + ", and can be resumed or deleted");
}

TEST_CASE("an import that is asked to stop begins nothing more, wherever it is")
{
    const Folder folder;
    const MemorySource source = noise<uint16_t>({200, 200, 200}, VoxelType::uint16, 12);
    constexpr int THREADS = 2;
    int stopped = 0, most_after = 0;
    for (int reads = 1; reads < 400; reads = reads * 2 + 1) {
        const Interrupted interrupted(source, reads, false);
        try {
            folder.import(interrupted, "project",
                          {.preparation = {.blur_sigma_voxels = glm::dvec3(2.0)},
                           .threads = THREADS,
                           .cancel = &interrupted.stop});
            break;  // it has ended before as many reads
        } catch (const ImportStopped&) {
            most_after = std::max(most_after, interrupted.reads() - reads);
            ++stopped;
        }
        fs::remove_all(folder.path / "project");
        fs::remove_all(folder.path / "project.part");
    }
    CHECK(stopped > 3);
    CHECK(most_after < THREADS);  // reads that had begun
}
