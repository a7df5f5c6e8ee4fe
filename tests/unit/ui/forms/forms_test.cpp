// What dialogs ask, as plain data: suggested names, the tasks that forms stand for, and estimates of sizes.

#include <filesystem>

#include <doctest/doctest.h>

#include "engine/annotation/trace/trace_file.h"
#include "engine/session/looks/key_look.h"
#include "engine/tasks/import_estimate.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/forms/export_form.h"
#include "engine/workbench/forms/figure_form.h"
#include "engine/workbench/forms/form_names.h"
#include "engine/workbench/forms/import_form.h"
#include "engine/workbench/forms/label_form.h"
#include "engine/workbench/forms/movie_form.h"
#include "engine/workbench/forms/volume_units.h"
#include "engine/workbench/forms/voxel_size.h"
#include "engine/workbench/words/task_words.h"
#include "tests/support/model_world.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct Scanned : World {
    Scanned()
    {
        path = "/scans/leaf.session.json";
        session.volume_path = "/scans/leaf.tif";
        volume.size = {64, 32, 16};
        volume.unit = "um";
    }
    /// Adds a node, linked with the one before it.
    void add_node(const glm::dvec3& at)
    {
        const auto number = uint32_t(trace.nodes().size());
        trace.apply(TraceNodeChange{number, {}, TraceNode{at, 1.5, 1}}, Direction::forwards);
        if (number > 0)
            trace.apply(TraceInternodeChange{number, {}, TraceInternode{number - 1, number, 1}}, Direction::forwards);
    }
};

}  // namespace

TEST_CASE("suggested names lie beside the scan or the project, without its endings")
{
    Scanned world;
    CHECK(base_of(world.model) == "/scans/leaf");
    world.path = "/scans/leaf-project/shvr/session.json";
    CHECK(base_of(world.model) == "/scans/leaf-project");
    world.path.clear();
    CHECK(base_of(world.model) == "/scans/leaf");
    CHECK(stem_of("/a/b.nii.gz") == "/a/b");
    CHECK(stem_of("/a/slices/") == "/a/slices");
    CHECK(placed("b", "/a") == "/a/b");
    CHECK(placed("../b", "/a/c") == "/a/b");
    CHECK(placed("/b", "/a") == "/b");
    CHECK(placed("", "/a").empty());
    CHECK(project_for("/scans/leaf.ome.tif") == "/scans/leaf-project");
    CHECK(project_for("https://host/scan.zarr").empty());
    CHECK(bytes_in_words(32768) == "33 kB");
    CHECK(bytes_in_words(999.0) == "999 bytes");
    CHECK(bytes_in_words(1.44e9) == "1.4 GB");
}

TEST_CASE("an export suggests all annotation that there is, and writes what is ticked, beside the scan")
{
    Scanned world;
    ExportForm form = suggested_export(world.model, {});
    CHECK(form.mask.is_written);  // an empty one, since there is nothing else
    CHECK_FALSE(form.trace.is_written);
    CHECK_FALSE(rows_of(form, world.model)[1].why_not.empty());
    world.model.voxels_by_group[3] = 7;
    world.add_node({1.0, 2.0, 3.0});
    form = suggested_export(world.model, form);
    CHECK(form.base == "/scans/leaf");
    const std::vector<ExportRow> rows = rows_of(form, world.model);
    REQUIRE(rows.size() == 4);
    CHECK(rows[0].file == "leaf-mask.nrrd");
    CHECK(rows[0].size == "33 kB");  // one byte for each of 64 x 32 x 16 voxels
    for (const ExportRow& row : rows) {
        CHECK(row.why_not.empty());
        CHECK(row.part->is_written == (row.part != &form.surfaces));  // they take longest
    }
    ExportTask task = task_of(form, "/scans");
    CHECK(task.mask == "/scans/leaf-mask.nrrd");
    CHECK(task.trace == "/scans/leaf-trace.graphml");
    CHECK(task.metrics == "/scans/leaf-measures.csv");
    CHECK(task.offset.empty());
    form.base = "out/spike";
    form.measures.is_written = false;
    form.trace.ending = ".swc";
    form.more.mesh = "tubes.ply";
    task = task_of(form, "/scans");
    CHECK(task.trace == "/scans/out/spike-trace.swc");
    CHECK(task.metrics.empty());
    CHECK(task.mesh == "/scans/out/tubes.ply");
    for (const char* unnamed : {"", "/scans/"}) {
        form.base = unnamed;
        CHECK(task_of(form, "/scans").mask.empty());
    }
}

TEST_CASE("surfaces are offered where something is painted, with a size that they stay below")
{
    Scanned world;
    ExportForm form = suggested_export(world.model, {});
    CHECK(rows_of(form, world.model)[3].why_not == "nothing is painted yet");
    world.model.voxels_by_group[2] = 3;
    world.model.voxels_by_group[9] = 4;
    form = suggested_export(world.model, {});
    CHECK(task_of(form, "/scans").surface.empty());
    form.surfaces.is_written = true;
    CHECK(rows_of(form, world.model)[3].file == "leaf-surface.ply");
    CHECK(task_of(form, "/scans").surface == "/scans/leaf-surface.ply");
    CHECK(files_of_surfaces(form, world.model) == 1);
    form.surfaces.ending = ".stl";
    CHECK(rows_of(form, world.model)[3].file == "leaf-surface-N.stl");
    CHECK(files_of_surfaces(form, world.model) == 2);
    form.more.surface_groups = "2";
    CHECK(files_of_surfaces(form, world.model) == 1);

    // Pairs of voxels side by side, and as many alone.
    Mask mask(world.volume.size);
    const auto paint = [&](const Size3& voxel) {
        const auto at = uint16_t(index_in_brick(voxel));
        mask.apply({.brick = 0, .runs = {{at, at, 0, 2}}}, Direction::forwards);
    };
    for (int64_t i = 0; i < 64; ++i) {
        paint({i % 8 * 4, i / 8 * 4, 3});
        if (i % 2 == 0) paint({i % 8 * 4 + 1, i / 8 * 4, 3});
    }
    world.model.voxels_by_group[2] = mask.voxels_by_group()[2];
    world.model.voxels_by_group[9] = 0;
    const TemporaryFolder folder;
    const DensityField density(world.volume.size, world.volume.type);
    for (const char* ending : {".ply", ".stl", ".obj", ".glb"}) {
        CAPTURE(ending);
        form.surfaces.ending = ending;
        form.base = folder.path / "a";
        ExportTask task = task_of(form, folder.path);
        task.mask = task.metrics = std::filesystem::path();
        task.smooth = 0;
        PlainReporter reporter;
        const ExportResult result = run(task, {world.volume, mask, density, world.trace, {}}, reporter);
        REQUIRE(result.written.size() == 1);
        const std::string words = rows_of(form, world.model)[3].size;
        REQUIRE(words.starts_with("usually below "));
        const double bytes = double(std::filesystem::file_size(result.written[0]));
        const double most = std::stod(words.substr(14)) * (words.ends_with(" kB") ? 1000.0 : 1.0);
        CHECK(bytes < most);
        CHECK(bytes > most / 6.0);
    }
}

TEST_CASE("the estimated size of a trace is within a factor of two of its file's")
{
    Scanned world;
    for (int i = 0; i < 500; ++i) world.add_node({1.0 + 0.123 * i, 20.0 + 0.017 * i, 3.0 / (i + 1)});
    ExportForm form;
    for (const char* ending : {".graphml", ".swc", ".rsml", ".txt"}) {
        CAPTURE(ending);
        form.trace.ending = ending;
        const std::string estimate = rows_of(form, world.model)[1].size;
        REQUIRE(estimate.starts_with("about "));
        const double kilobytes = std::stod(estimate.substr(6));
        const double bytes = double(trace_text(std::string("a") + ending, world.trace, space_of(world.volume)).size());
        CAPTURE(bytes);
        CHECK(1000.0 * kilobytes > bytes / 2.0);
        CHECK(1000.0 * kilobytes < bytes * 2.0);
    }
}

TEST_CASE("an import suggests a project beside the scan, until one is typed")
{
    Scanned world;
    ImportForm form = suggested_import(world.model, {});
    CHECK(form.volume == "/scans/leaf.tif");
    CHECK(form.project == "/scans/leaf-project");
    form.volume = "/other/stem.nrrd";
    follow_volume(form);
    CHECK(form.project == "/other/stem-project");
    form.project = "mine";
    form.volume = "/third/root.nrrd";
    follow_volume(form);
    const ImportTask task = task_of(form, "/scans");
    CHECK(task.volume == "/third/root.nrrd");
    CHECK(task.project == "/third/mine");
    CHECK(suggested_import(world.model, "/a/b.nrrd").volume == "/a/b.nrrd");
}

TEST_CASE("an import has the spacing that a person gave the open scan, and that its file lacks")
{
    Scanned world;
    world.volume.spacing = {3.0, 3.0, 4.5};
    CHECK(suggested_import(world.model, {}).voxel_size.empty());  // the file states it
    world.volume.spacing_from = Provenance::given;
    ImportForm form = suggested_import(world.model, {});
    const ImportTask task = task_of(form, "/scans");
    CHECK(task.choice.spacing == glm::dvec3(3.0, 3.0, 4.5));
    CHECK(task.choice.unit == "um");
    CHECK(suggested_import(world.model, "/a/b.nrrd").voxel_size.empty());
    form.volume = "/a/b.nrrd";
    follow_volume(form);
    CHECK(form.voxel_size.empty());
    form.voxel_size = "2 um";
    form.volume = "/a/c.nrrd";
    follow_volume(form);
    CHECK(form.voxel_size == "2 um");   // typed
    world.session.volume_path.clear();  // as of a procedural scan, which no project can be made of
    CHECK(suggested_import(world.model, {}).voxel_size.empty());
}

TEST_CASE("what an import would make is told from the scan's header, with a free name where one is taken")
{
    const TemporaryFolder folder;
    const std::filesystem::path scan =
        folder.write("scan.nrrd",
                     "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 10 8 6\nspacings: 2 2 3\nencoding: raw\n"
                     "endian: little\n\n" +
                         std::string(960, '\1'));
    ImportTask task{.volume = scan, .project = folder.path / "scan-project"};
    ImportEstimate estimate = estimate_of(task);
    CHECK(estimate.scan.spacing == glm::dvec3(2.0, 2.0, 3.0));
    CHECK(estimate.size == Size3(10, 8, 6));
    CHECK(estimate.most_bytes == doctest::Approx(960.0 * 8.0 / 7.0));
    CHECK(estimate.free_bytes.value_or(0.0) > 0.0);
    CHECK(bytes_written(estimate).most >= estimate.most_bytes);
    CHECK(bytes_written(estimate).least > 0.0);
    CHECK(look_at_place(task).free_name.empty());
    task.downscale = 2;
    CHECK(estimate_of(task).size == Size3(5, 4, 3));
    std::filesystem::create_directory(task.project);
    std::filesystem::create_directory(folder.path / "scan-project-2");
    CHECK(look_at_place(task).free_name == folder.path / "scan-project-3");
    CHECK(look_at_place(task).why_not.empty());  // an empty folder counts as absent
    task.volume = folder.path / "gone.nrrd";
    CHECK(error_of([&] { static_cast<void>(estimate_of(task)); }).find("gone.nrrd") != std::string::npos);
}

TEST_CASE("an import says what it replaces, and names the annotation that is lost with it")
{
    const TemporaryFolder folder;
    ImportTask task{.volume = folder.path / "scan.nrrd", .project = folder.path / "plant", .overwrite = true};
    CHECK(words_of_replacement(task, look_at_place(task)).empty());
    std::filesystem::create_directories(task.project / "shvr");
    folder.write("plant/.zattrs", "{}");
    CHECK(words_of_replacement(task, look_at_place(task)) ==
          "plant exists and will be replaced. It holds no annotation.");
    std::filesystem::create_directories(task.project / "labels" / "paint");
    folder.write("plant/labels/.zgroup", "{}");
    folder.write("plant/shvr/paint.graphml", "");
    folder.write("plant/shvr/session.json", "{}");
    CHECK(words_of_replacement(task, look_at_place(task)) ==
          "plant exists and will be deleted, with its annotation: paint (labels/paint), a trace (shvr/paint.graphml). "
          "Undo does not bring that back.");
    task.overwrite = false;
    const ImportPlace kept = look_at_place(task);
    CHECK(words_of_replacement(task, kept).empty());
    CHECK(kept.why_not == task.project.string() + ": exists already; expected a new name, or Overwrite under More");
    CHECK(kept.free_name == folder.path / "plant-2");
}

TEST_CASE("an import offers to overwrite nothing but projects, and says at once where none can be made")
{
    const TemporaryFolder folder;
    const auto why = [&](const char* name, bool overwrites) {
        const ImportTask task{
            .volume = folder.path / "scan.nrrd", .project = folder.path / name, .overwrite = overwrites};
        return look_at_place(task).why_not;
    };
    folder.write("notes.txt", "mine");
    std::filesystem::create_directory(folder.path / "thesis");
    folder.write("thesis/text.txt", "mine");
    std::filesystem::create_directory(folder.path / "mixed");
    folder.write("mixed/.zattrs", "{}");
    folder.write("mixed/text.txt", "mine");
    for (const bool overwrites : {false, true}) {
        CHECK(why("notes.txt", overwrites).ends_with("notes.txt: is a file; expected a new name"));
        CHECK(why("thesis", overwrites).ends_with("thesis: is a folder, but no project; expected a new name"));
        CHECK(why("mixed", overwrites).ends_with("mixed: holds text.txt, no part of it; expected a new name"));
    }
    CHECK(why("none/project", false).find("there is no folder") != std::string::npos);
    CHECK(why(std::string(300, 'x').c_str(), false).find("is too long, with 300 bytes") != std::string::npos);
    CHECK(look_at_place({.volume = "scan.nrrd", .project = "/proc/q"}).why_not.find("may not be written to") !=
          std::string::npos);
}

TEST_CASE("a project of an annotated scan begins without annotation, and it is said how that is loaded")
{
    Scanned world;
    world.session.mask_path = "/scans/leaf.mask";
    world.session.trace_path = "/scans/leaf.graphml";
    ImportForm form = suggested_import(world.model, {});
    CHECK(words_of_annotation(form, world.model).empty());
    world.model.voxels_by_group[3] = 7;
    CHECK(words_of_annotation(form, world.model) ==
          "The project begins without the annotation of this scan, which stays with the scan. Load annotation brings "
          "it into the project, from leaf.mask.");
    world.add_node({1.0, 2.0, 3.0});
    CHECK(words_of_annotation(form, world.model).ends_with("from leaf.mask and leaf.graphml."));
    form.more.downscale = 2;
    CHECK(words_of_annotation(form, world.model).ends_with("it fits the whole scan alone."));
    form.volume = "/scans/other.tif";
    CHECK(words_of_annotation(form, world.model).empty());
}

TEST_CASE("too little space is refused where that is certain, and told where it is possible")
{
    CHECK(words_of_space({100.0, 200.0}, std::nullopt).warning.empty());
    CHECK(words_of_space({100.0, 200.0}, 200.0).warning.empty());
    const SpaceWords possible = words_of_space({100.0, 200e3}, 66e3);
    CHECK(possible.refusal.empty());
    CHECK(possible.warning == "This may take up to 200 kB, and only 66 kB are free on that disk.");
    const SpaceWords certain = words_of_space({4.1e6, 4.2e6}, 0.0);
    CHECK(certain.warning.empty());
    CHECK(certain.refusal ==
          "This takes at least 4.1 MB, and 0 bytes are free on that disk: free some space, or choose another folder.");
    Scanned world;
    world.model.voxels_by_group[3] = 7;
    world.add_node({1.0, 2.0, 3.0});
    ExportForm form = suggested_export(world.model, {});
    const BytesNeeded plain = bytes_written(form, world.model);
    CHECK(plain.least == 32768.0);  // one byte for each of 64 x 32 x 16 voxels
    CHECK(plain.most > plain.least);
    form.mask.ending = ".zarr";
    CHECK(bytes_written(form, world.model).least == 0.0);
    CHECK(bytes_written(form, world.model).most == plain.most);
    LabelForm label = suggested_label(world.model);
    CHECK(bytes_written(label, world.model).most == 0.0);  // it only counts
    label.writes_labels = true;
    CHECK(bytes_written(label, world.model).most == 4.0 * 32768.0);
    CHECK(bytes_written(label, world.model).least == 0.0);
    label.output = "/scans/parts.mask";
    CHECK(bytes_written(label, world.model).least == 32768.0);
}

TEST_CASE("blanks around the name of a new file are left out")
{
    Scanned world;
    ExportForm exported = suggested_export(world.model, {});
    exported.base = " a ";
    CHECK(task_of(exported, "/scans").mask == "/scans/a-mask.nrrd");
    CHECK(rows_of(exported, world.model)[0].file == "a-mask.nrrd");
    CHECK(task_of(ImportForm{.volume = "/scans/leaf.tif", .project = "p "}, "/scans").project == "/scans/p");
    CHECK(task_of(LabelForm{.writes_labels = true, .output = " parts.zarr "}, "/scans").output == "/scans/parts.zarr");
    CHECK(task_of(FigureForm{.path = "f.png "}, "/scans").path == "/scans/f.png");
    MovieForm movie{.path = "m ", .kind = MovieKind::webm};
    CHECK(task_of(movie, "/scans").path == "/scans/m.webm");
    choose_kind(movie, MovieKind::mp4);
    CHECK(movie.path == "m.mp4");
    CHECK(why_not(ImportForm{.volume = "/a/b.tif", .project = "  "}).starts_with("name the folder"));
}

TEST_CASE("options have titles in the dialogs' messages, not keys")
{
    CHECK(option_title("budget_host_mib") == "Memory in MiB");
    CHECK(option_title("break_loops") == "Break loops");
    ImportForm form{.volume = "/a/b.tif", .project = "/a/p"};
    form.more.allows_incomplete = true;
    form.more.reverse = true;
    CHECK(error_of([&] { check(task_of(form, "/a")); }).starts_with("Skip unreadable is given with Reverse"));
}

TEST_CASE("labelling counts at the paint threshold, and writes where it is asked to")
{
    Scanned world;
    world.session.probe.brush.threshold = 120.0;
    LabelForm form = suggested_label(world.model);
    CHECK(task_of(form, "/scans").threshold == 120.0);
    CHECK(task_of(form, "/scans").output.empty());
    form.writes_labels = true;
    CHECK(task_of(form, "/scans").output == "/scans/leaf-parts.zarr");
    CHECK(size_of_labels(form, world.model) == "at most 131 kB");
    form.more.largest = 10;
    CHECK(size_of_labels(form, world.model) == "at most 33 kB");
    CHECK(why_not(form).empty());
    form.more.fewest_voxels = -5;
    CHECK(why_not(form) == "the smallest part has -5 voxels; expected 1 or more");
    form.more.fewest_voxels = 1;
    form.output = " ";
    CHECK(why_not(form) == "name the file of the labels");
}

TEST_CASE("the size of a voxel is typed in one line, with one number or three and the unit")
{
    const auto read = [](const char* text) {
        const std::optional<VoxelSize> size = voxel_size_of(text);
        return size ? shvr::ui::text_of(*size) : std::string("none");
    };
    CHECK(read("0.8 x 0.8 x 1.2 um") == "0.8 x 0.8 x 1.2 um");
    CHECK(read("  0.1,0.2 , 3 ") == "0.1 x 0.2 x 3");
    CHECK(read("0.5*0.5*2 mm") == "0.5 x 0.5 x 2 mm");
    CHECK(read("4 \u00b5m") == "4 x 4 x 4 um");
    CHECK(read("2") == "2 x 2 x 2");
    CHECK(read("0.8x0.8x1.2um") == "0.8 x 0.8 x 1.2 um");
    CHECK(read("1e-3 mm") == "0.001 x 0.001 x 0.001 mm");
    CHECK(read("1,5 um") == "1.5 x 1.5 x 1.5 um");
    CHECK(read("0,8 x 0,8 x 1,2 um") == "0.8 x 0.8 x 1.2 um");
    CHECK(read("0,5 0,5 2") == "0.5 x 0.5 x 2");
    CHECK(read("1,1,2 mm") == "1 x 1 x 2 mm");
    for (const char* wrong : {"", "um", "1 2", "1 2 3 4", "0 1 1", "-1 1 1", "1 1 nan", "1 1 1 um mm", "um 1 1 1",
                              "1 2,5", "1,2,3,4", "1,2.5"}) {
        CAPTURE(wrong);
        CHECK(read(wrong) == "none");
    }
    CHECK(read("5 Micrometers") == "5 x 5 x 5 um");
    for (const char* right : {"2", "0.8 x 0.8 x 1.2 um", "4 inch", "1 voxel"}) CHECK(why_no_voxel_size(right).empty());
    CHECK(why_no_voxel_size("5 parsec").starts_with("the unit \"parsec\" is not known here; expected um, mm"));
    CHECK(why_no_voxel_size("5 parsec", "parsec").empty());  // the file states it
    CHECK(why_no_voxel_size("1e-300 um") == "the size 1e-300 is out of range; expected 1e-12 to 1e+12");
    CHECK(why_no_voxel_size("1 2") == EXPECTED_VOXEL_SIZE);
    ImportForm form{.volume = "/a/b.tif", .project = "/a/p", .voxel_size = "5 parsec"};
    CHECK(why_not(form).starts_with("the unit \"parsec\""));
    form.voxel_size = "0.1 um";
    CHECK(why_not(form).empty());
    CHECK(task_of(form, "").choice.spacing == glm::dvec3(0.1));
    CHECK(task_of(form, "").choice.unit == "um");
    form.voxel_size = "0.1 0.2";
    CHECK(why_not(form).find("'0.1 0.2' is no size; expected") != std::string::npos);
    CHECK(why_not(ImportForm{}).starts_with("name the scan"));
    CHECK(why_not(ImportForm{.volume = "/a/b.tif"}).starts_with("name the folder"));
}

TEST_CASE("a volume without a unit of length has lengths in voxels, and no parts in cubic millimetres")
{
    VolumeInfo volume;
    CHECK(unit_of_lengths(volume) == "voxels");
    CHECK_FALSE(has_cubic_millimetres(volume));
    volume.unit = "um";
    CHECK(unit_of_lengths(volume) == "\u00b5m");
    CHECK(has_cubic_millimetres(volume));
    volume.unit = "parsec";  // nothing is known of it
    CHECK(unit_of_lengths(volume) == "parsec");
    CHECK_FALSE(has_cubic_millimetres(volume));
}

TEST_CASE("what a task has done is told with its folder, counts and integers as integers")
{
    const std::vector<std::string> one{"/scans/leaf-mask.nrrd"},
        three{"/scans/leaf-trace.swc", "/scans/leaf-mask.nrrd", "/scans/leaf-measures.csv"},
        apart{"/scans/a.swc", "/other/a.nrrd"};
    CHECK(exported_in_words(one, 262144) == "Exported leaf-mask.nrrd to /scans (262 kB)");
    CHECK(exported_in_words(three, 0) == "Exported leaf-trace.swc, leaf-mask.nrrd and leaf-measures.csv to /scans");
    CHECK(exported_in_words(apart, 0) == "Exported /scans/a.swc and /other/a.nrrd");
    LabelTask task{.threshold = 1048576.0};
    CHECK(labelled_in_words({.found = 12, .largest_voxels = 4096}, task) ==
          "Found 12 connected parts at or above 1048576, the largest of 4096 voxels");
    task.output = "/scans/parts.zarr";
    CHECK(labelled_in_words({.found = 1, .largest_voxels = 1}, task) ==
          "Found 1 connected part at or above 1048576, the largest of 1 voxel; the labels are in /scans/parts.zarr");
    CHECK(labelled_in_words({}, LabelTask{}) == "Found 0 connected parts at or above 0");
}

TEST_CASE("a figure has the pixels of its size on paper, and keeps them in another unit")
{
    SizeForm size{.width = 85.0, .height = 60.0, .dots_per_inch = 300.0};
    CHECK(pixels_of(size) == glm::ivec2(1004, 709));
    change_unit(size, false);
    CHECK(size.width == 1004.0);
    CHECK(pixels_of(size) == glm::ivec2(1004, 709));
    change_unit(size, true);
    CHECK(size.width == 85.0);
    CHECK(size.height == 60.0);
    CHECK(pixels_of({.width = 0.0, .height = 10.0}) == glm::ivec2(0));
    CHECK(pixels_of({.width = 10.0, .height = 10.0, .dots_per_inch = 1.0}) == glm::ivec2(0));
    CHECK(pixels_of({.width = 65537.0, .height = 10.0, .is_in_mm = false}) == glm::ivec2(0));
}

TEST_CASE("a figure is suggested next to the scan, in the ending of the last one, with a text that was only typed")
{
    Scanned world;
    world.model.probe_voxel = glm::dvec3(1.0, 2.0, 3.0);
    FigureForm form = suggested_figure(world.model, {.path = "/else/a.tif"});
    CHECK(form.path == "/scans/leaf-figure.tif");
    form.elements.next_text = "pith";
    const FigureTask task = task_of(form, "/scans");
    CHECK(task.path == "/scans/leaf-figure.tif");
    CHECK(task.elements.has_scale_bar);
    CHECK(task.dots_per_inch == 300.0);
    REQUIRE(task.elements.texts.size() == 1);
    CHECK(task.elements.texts[0].text == "pith");
    CHECK(task.elements.texts[0].voxel == world.model.probe_voxel);
    form.size.is_in_mm = false;
    CHECK(task_of(form, "/scans").dots_per_inch == 0.0);
    CHECK(why_not(form).empty());
    form.size.height = 0.0;
    CHECK(why_not(form).starts_with("the size is 85 x 0 pixels; expected 1 to 65536 pixels"));
    CHECK(why_not(suggested_figure(world.model, form)).empty());
    // Words stay while the scan is open, for the figure's next version.
    form.elements.drawn.title = "Bellis";
    form = suggested_figure(world.model, form);
    CHECK((form.elements.drawn.title == "Bellis" && form.elements.next_text == "pith"));
    world.session.volume_path = "/scans/stem.tif";
    form = suggested_figure(world.model, form);
    CHECK((form.elements.drawn.title.empty() && form.elements.next_text.empty()));
}

TEST_CASE("a figure and a movie come back from their lines, and say what they cannot be")
{
    Scanned world;
    FigureTask figure{.path = "/a/b.png", .pixels = {10, 20}, .elements = {.has_axes = true}};
    figure.elements.texts.push_back({{1.0, 2.0, 3.0}, "pith"});
    const Action read = read_action(line_of(Action(figure)), "line");
    CHECK(line_of(read) == line_of(Action(figure)));
    CHECK(read.as<FigureTask>()->elements.texts[0].text == "pith");
    figure.path = "/a/b.jpg";
    CHECK(why_not(world.model, Action(figure)) ==
          "the figure's name is \"b.jpg\"; expected one that ends in .png or .tif");
    const MovieTask titled{.path = "/a/m.webm", .elements = {.has_color_bar = true, .title = "leaf"}};
    CHECK(read_action(line_of(Action(titled)), "line").as<MovieTask>()->elements.title == "leaf");
    const MovieTask still{.path = "/a/m.webm"};
    CHECK(why_not(world.model, Action(still)).find("stands still") != std::string::npos);
    CHECK(why_not(world.model, Action(MovieTask{.path = "/a/m.webm", .turntable_degrees = 360.0})).empty());
    CHECK(why_not(world.model, Action(MovieTask{.path = "/a/m.webm", .views = "front\ntop"})).empty());
}

TEST_CASE("a movie does not go through views of different projections")
{
    Scanned world;
    world.session.cameras["flat"] = Camera{.projection = Camera::Projection::orthographic};
    world.session.cameras["mine"] = Camera{};
    const auto refusal = [&](const char* views) {
        return why_not(world.model, Action(MovieTask{.path = "/a/m.webm", .views = views}));
    };
    CHECK(refusal("mine\ntop") == "");
    CHECK(refusal("top\nmine\nflat") ==
          "flat is orthographic, and top is perspective; expected views of the same projection");
}

TEST_CASE("a movie goes through views that were kept with their looks, in the order of their numbers")
{
    Scanned world;
    const auto keep = [&](const char* view, double upper) {
        world.session.cameras[view] = Camera{};
        world.session.key_looks[view] = key_look_of(world.session);
        world.session.key_looks[view].cut.upper.x = upper;
    };
    world.session.cameras["view 3"] = Camera{};  // without a look
    keep("view 10", 9.0);
    keep("view 2", 64.0);
    MovieForm form = suggested_movie(world.model, {});
    CHECK(form.goes_through_views);
    CHECK(form.views == std::vector<std::string>{"view 2", "view 10"});
    CHECK(change_between(world.session, "view 2", "view 10") == "changes cut");
    world.session.light.ambient = 0.9;
    CHECK(change_between(world.session, "view 10", "top") == "changes cut, light");
    CHECK(change_between(world.session, "view 3", "top").empty());
    move_up(form, 1);
    move_up(form, 0);
    CHECK(task_of(form, "/scans").views == "view 10\nview 2");

    // What was removed stays away; what is kept later follows.
    form.views = {"view 10"};
    keep("view 4", 5.0);
    form = suggested_movie(world.model, form);
    CHECK(form.views == std::vector<std::string>{"view 10", "view 4"});
    world.session.cameras.erase("view 10");
    world.session.key_looks.erase("view 10");
    form = suggested_movie(world.model, form);
    CHECK(form.views == std::vector<std::string>{"view 4"});
    world.path = "/scans/root.session.json";
    CHECK(suggested_movie(world.model, form).views == std::vector<std::string>{"view 4", "view 2"});
}

TEST_CASE("a movie has the frames of its seconds, and the ending of its format")
{
    Scanned world;
    MovieForm form = suggested_movie(world.model, {});
    CHECK(form.path == "/scans/leaf-movie.webm");
    choose_kind(form, MovieKind::frames);
    CHECK(form.path == "/scans/leaf-movie");
    choose_kind(form, MovieKind::mp4);
    CHECK(task_of(form, "/scans").path == "/scans/leaf-movie.mp4");
    form.seconds = 2.5;
    CHECK(task_of(form, "/scans").frames == 75);
    CHECK(task_of(form, "/scans").turntable_degrees == 360.0);
    CHECK(why_not(form).empty());
    form.more.pixels.x = 641;
    CHECK(why_not(form) == "the size is 641 x 720 pixels; expected even numbers from 2");
    choose_kind(form, MovieKind::frames);
    CHECK(why_not(form).empty());
    form.goes_through_views = true;
    CHECK(why_not(form).starts_with("no way is chosen"));
    form.views = {"front", "top"};
    CHECK(why_not(form).empty());
    CHECK(task_of(form, "/scans").views == "front\ntop");
    CHECK(task_of(form, "/scans").turntable_degrees == 0.0);
    form.seconds = 0.0;
    CHECK(why_not(form).find("expected 1 to 100000 frames") != std::string::npos);
    form.more.pixels.x = 0;
    const MovieForm again = suggested_movie(world.model, form);
    CHECK(again.seconds == 4.0);
    CHECK(again.more.pixels == glm::ivec2(1280, 720));
}
