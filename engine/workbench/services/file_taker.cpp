#include "engine/workbench/services/file_taker.h"

#include <algorithm>
#include <span>
#include <utility>

#include "engine/base/assets.h"
#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/remote/address.h"
#include "engine/session/label_looks.h"
#include "engine/session/lasting_settings.h"
#include "engine/session/looks/named_look.h"
#include "engine/session/meshes/session_meshes.h"
#include "engine/session/session_patch.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/words/load_words.h"

namespace shvr::ui {

namespace {

constexpr int64_t MAX_JSON_BYTES = int64_t{16} << 20;

std::vector<std::string> lines_of(const std::string& text)
{
    std::vector<std::string> lines;
    for (size_t begin = 0; begin < text.size();) {
        const size_t end = std::min(text.find('\n', begin), text.size());
        if (end > begin) lines.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return lines;
}

/// Otherwise it belongs to what is open.
bool is_opened(FileContent content)
{
    return content == FileContent::volume || content == FileContent::session || content == FileContent::project ||
           content == FileContent::picture;
}

/// Returns whether the points of a transfer function are relative to a volume's tissue, as in files of presets, and not
/// intensities.
bool is_preset(const std::string& text, const std::filesystem::path& path)
{
    const JsonDocument json(text, path.string());
    const JsonNode points = json.root()["points"];
    return points.is_array() && points.count() > 0 && points.elements()[0]["at"].exists();
}

FileUse use_of(FileContent content)
{
    return content == FileContent::mask      ? FileUse::mask
           : content == FileContent::offsets ? FileUse::offsets
           : content == FileContent::trace   ? FileUse::trace
           : content == FileContent::mesh    ? FileUse::mesh
                                             : FileUse::look;
}

}  // namespace

FileTaker::FileTaker(Desk& desk, Others others) : Service(desk), others_(std::move(others)) {}

void FileTaker::act(const Open& action)
{
    candidate_.reset();
    unclear_.reset();
    preview_.reset();
    previewed_.reset();
    to_preview_.clear();
    if (action.saves_outside) others_.allow_outside(action.path);
    others_.begin_open(action.path, lines_of(action.settings), {}, action.settings.empty());
}

/// Opens the user's own copy of the example. The shipped example stays unchanged, since other users open it, too.
void FileTaker::act(const OpenExample&)
{
    if (options_.settings.empty())
        fail("no folder for the example is known; expected HOME or XDG_CONFIG_HOME in the environment");
    const std::filesystem::path own = options_.settings / "example" / "vessels.json";
    jobs_.start("getting the example", [this, own](ProgressReporter&) {
        const std::filesystem::path shipped = asset_folder("examples") / "vessels.session.json";
        if (!std::filesystem::exists(own)) {
            const std::string text = read_text(shipped, MAX_JSON_BYTES);
            std::filesystem::create_directories(own.parent_path());
            write_file_atomically(own, std::as_bytes(std::span(text)));
        }
        return Jobs::Completion([this, own] { others_.begin_open(own, {}, {}, false); });
    });
}

// ---- Inspection of files before they are opened ---------------------------------------------------------------------

void FileTaker::act(const LookAtFile& action)
{
    candidate_.reset();
    if (action.path.empty()) return;
    candidate_ = std::make_unique<Candidate>(Candidate{.path = action.path, .settings = action.settings});
    jobs_.start("looking at " + short_name(action.path), [this, action, &renderer = renderer_](ProgressReporter&) {
        Candidate found{.path = action.path, .settings = action.settings, .is_being_read = false};
        try {
            const UnmeasuredSession opened = open_unmeasured_session(action.path, lines_of(action.settings));
            const Session& session = opened.session;
            found.is_project = !session_file_of(action.path).empty();
            found.kind = !opened.pictured.empty() ? "Picture of a session"
                         : found.is_project       ? "Session or project"
                         : session.raw_layout     ? "Bare voxels"
                                                  : "Volume";
            found.volume = opened.source->info();
            found.levels = opened.source->levels();
            found.warnings = opened.losses;
            for (const std::string& setting : opened.removed) found.warnings.push_back(setting);
            for (const std::string& warning : found.volume.warnings) found.warnings.push_back(warning);
            const SceneEstimate estimate =
                renderer.estimate(*opened.source, session.render, shows_occlusion(session.light));
            found.memory = in_words(estimate);
            found.failure = estimate.refusal;
        } catch (const Error& error) {
            found.failure = error.what();
            found.choices = choices_of(error);
        }
        return Jobs::Completion([this, found = std::move(found)] {
            const bool is_wanted =
                candidate_ && candidate_->path == found.path && candidate_->settings == found.settings;
            if (is_wanted) *candidate_ = found;
        });
    });
}

// ---- Files dropped onto the window ----------------------------------------------------------------------------------

void FileTaker::act(const TakeFile& action)
{
    unclear_.reset();
    const Step step = action.previews ? Step::preview_in_turn : Step::load;
    std::vector<std::filesystem::path> others;
    for (const std::string& line : lines_of(action.beside)) others.emplace_back(line);
    if (action.use == FileUse::scan) return others_.begin_open(action.path, {}, others, false);
    if (is_address(action.path.string()) && others.empty()) return others_.begin_open(action.path, {}, {}, true);
    if (action.use != FileUse::by_contents) {
        take_as(action.use, action.path, step);
        for (const std::filesystem::path& path : others) act(TakeFile{.path = path, .previews = action.previews});
        return;
    }
    if (!others.empty()) {
        others.insert(others.begin(), action.path);
        return take_together(std::move(others), step);
    }
    std::optional<VolumeInfo> volume;
    if (document_) volume = document_->volume();
    const std::filesystem::path open = document_ ? document_->session.volume_path : std::filesystem::path();
    jobs_.start("looking at " + short_name(action.path),
                [this, path = action.path, step, volume, open](ProgressReporter&) {
                    WhatItIs found = what_is(path, volume ? &*volume : nullptr);
                    // The file of the open scan cannot also be annotation of that scan.
                    std::error_code ignored;
                    if (found.may_be_annotation && std::filesystem::equivalent(path, open, ignored))
                        found = {.content = FileContent::volume};
                    return Jobs::Completion([this, path, step, found] {
                        if (found.may_be_annotation) return ask_what_it_is({.path = path});
                        if (!found.content) fail(found.why_not);
                        take(*found.content, path, step);
                    });
                });
}

void FileTaker::act(const DismissUnclearFile&)
{
    unclear_.reset();
}

/// A script cannot be asked.
void FileTaker::ask_what_it_is(UnclearFile file)
{
    if (options_.is_script)
        fail(file.path.string(), ": could be ", file.may_be_scan ? "a scan, " : "",
             "a mask or density offsets; expected \"what\" or \"use\" to state which");
    say(file.path.string() + " " + file.why + "; choose what it is", Weight::done);
    unclear_ = std::move(file);
}

/// Takes several files. Annotation that is dropped with a scan must not be added to the scan that is still open. A
/// volume of the open scan's size counts as a scan if a mask is dropped with it; otherwise, the user is asked.
void FileTaker::take_together(std::vector<std::filesystem::path> paths, Step step)
{
    std::optional<VolumeInfo> volume;
    if (document_) volume = document_->volume();
    jobs_.start(sentence("looking at ", paths.size(), " files"), [this, paths, step, volume](ProgressReporter&) {
        std::vector<std::filesystem::path> opened, others;
        bool is_unclear = false, has_mask = false;
        for (const std::filesystem::path& path : paths) {
            const WhatItIs found = what_is(path, volume ? &*volume : nullptr);
            is_unclear = is_unclear || found.may_be_annotation;
            has_mask = has_mask || found.content == FileContent::mask;
            const bool may_open = found.may_be_annotation || (found.content && is_opened(*found.content));
            (may_open ? opened : others).push_back(path);
        }
        return Jobs::Completion([this, opened, others, step, asks = is_unclear && !has_mask,
                                 asks_of_labels = !has_mask] {
            if (opened.size() > 1)
                fail(opened[0].string(), " and ", opened[1].string(),
                     ": each can be opened; expected one scan, session or project at a time, alone or with its mask, "
                     "offsets and trace; slices of one scan are opened as their folder");
            if (opened.size() == 1 && asks) {
                std::string beside;
                for (const std::filesystem::path& path : others) beside += path.string() + '\n';
                return ask_what_it_is({.path = opened[0], .beside = beside});
            }
            if (opened.size() == 1) return others_.begin_open(opened[0], {}, others, asks_of_labels);
            for (const std::filesystem::path& path : others)
                act(TakeFile{.path = path, .previews = step != Step::load});
        });
    });
}

/// Transfer functions and meshes are not previewed: they are seen at once, and change no annotation.
void FileTaker::take(FileContent content, const std::filesystem::path& path, Step step)
{
    if (is_opened(content)) return others_.begin_open(path, {}, {}, true);
    const bool is_seen = content == FileContent::transfer_function || content == FileContent::mesh;
    take_as(use_of(content), path, is_seen ? Step::load : step);
}

// ---- Annotation and transfer functions loaded into the open document ------------------------------------------------

/// Data of a file that was read on the worker thread.
struct FileTaker::ReadFile {
    std::filesystem::path path;
    uint64_t opening = 0;        ///< number of the document for which the file was read (Desk::openings)
    std::optional<Part> part{};  ///< null: a transfer function or a mesh
    std::string text{};          ///< contents of a transfer function
    size_t triangles = 0;        ///< number of a mesh's triangles
    bool is_mesh = false;
    std::string mesh_warning{};  ///< empty if there is none
    std::shared_ptr<const shvr::Document> found{};
    LoadNotes notes{};
    Groups groups{}, looks{};  ///< the document's groups, without and with the names and colours that a mask adds

    FileUse use() const
    {
        return is_mesh                  ? FileUse::mesh
               : !part                  ? FileUse::look
               : *part == Part::mask    ? FileUse::mask
               : *part == Part::offsets ? FileUse::offsets
                                        : FileUse::trace;
    }
};

bool FileTaker::has_preview() const
{
    return preview_ && preview_opening_ == desk_.openings;
}

/// Never opens a document in place of the open scan, whatever the file contains: the user asked to add annotation.
void FileTaker::act(const LoadAnnotation& action)
{
    unclear_.reset();
    preview_.reset();
    const std::shared_ptr<const ReadFile> read = std::exchange(previewed_, nullptr);
    const bool is_read = read && read->path == action.path && read->opening == desk_.openings;
    const bool is_wanted = action.what == FileUse::by_contents || (is_read && read->use() == action.what);
    if (is_read && is_wanted) {
        try {
            load(*read);
        } catch (...) {
            show_next_preview();
            throw;
        }
        return show_next_preview();
    }
    if (action.what != FileUse::by_contents) return take_as(action.what, action.path);
    load_by_contents(action.path, Step::load);
}

void FileTaker::act(const PreviewLoad& action)
{
    unclear_.reset();
    preview_.reset();
    previewed_.reset();
    if (action.path.empty()) return show_next_preview();
    preview_ = LoadPreview{.path = action.path, .is_being_read = true};
    preview_opening_ = desk_.openings;
    if (action.what != FileUse::by_contents) return take_as(action.what, action.path, Step::preview);
    load_by_contents(action.path, Step::preview);
}

void FileTaker::load_by_contents(const std::filesystem::path& path, Step step)
{
    const auto look = [this, path, step, volume = document_->volume()](ProgressReporter&) {
        const WhatItIs found = what_annotation_is(path, volume);
        return Jobs::Completion([this, path, step, found] {
            const bool is_previewed = step == Step::preview && !options_.is_script;
            if (found.may_be_annotation && is_previewed)
                return refuse_preview(
                    path, sentence(path.string(), ": could be a mask or density offsets; choose which"), true);
            if (found.may_be_annotation) return ask_what_it_is({.path = path, .may_be_scan = false});
            if (!found.content && is_previewed) return refuse_preview(path, found.why_not);
            if (!found.content) fail(found.why_not);
            take_as(use_of(*found.content), path, step);
        });
    };
    start_reading("looking at " + short_name(path), path, step, look);
}

/// Starts a job that reads a file. If that fails, the preview of a dialog states why; otherwise the job fails.
void FileTaker::start_reading(const std::string& what, const std::filesystem::path& path, Step step,
                              Jobs::Function read)
{
    if (step != Step::preview || options_.is_script) {
        jobs_.start(what, std::move(read));
        return;
    }
    jobs_.start(what, [this, path, read = std::move(read)](ProgressReporter& reporter) -> Jobs::Completion {
        try {
            return read(reporter);
        } catch (const Stopped&) {
            throw;
        } catch (const std::exception& error) {
            return [this, path, why = told_of(error)] { refuse_preview(path, why); };
        }
    });
}

/// Says in the preview why there is none, unless another one was asked for meanwhile.
void FileTaker::refuse_preview(const std::filesystem::path& path, const std::string& why, bool is_unclear)
{
    if (!has_preview() || preview_->path != path || !preview_->is_being_read) return;
    preview_->is_being_read = preview_->changes_anything = false;
    preview_->failure = why;
    preview_->is_unclear = is_unclear;
}

void FileTaker::take_as(FileUse use, const std::filesystem::path& path, Step step)
{
    if (!document_) fail(path.string(), ": belongs to a volume; expected that to be open, to take it into");
    if (use == FileUse::look) return read_transfer_function(path, step);
    if (use == FileUse::mesh) return read_mesh_file(path, step);
    read_annotation(use == FileUse::mask      ? Part::mask
                    : use == FileUse::offsets ? Part::offsets
                                              : Part::trace,
                    path, step);
}

void FileTaker::read_transfer_function(const std::filesystem::path& path, Step step)
{
    const auto reading = [this, path, step, opening = desk_.openings](ProgressReporter&) {
        const auto read = std::make_shared<ReadFile>(
            ReadFile{.path = path, .opening = opening, .text = read_text(path, MAX_JSON_BYTES)});
        return Jobs::Completion([this, read, step] { go_on_with(read, step); });
    };
    start_reading("reading " + short_name(path), path, step, reading);
}

/// Reads a mesh to the end, so that one that cannot be drawn is refused before it is in the session.
void FileTaker::read_mesh_file(const std::filesystem::path& path, Step step)
{
    const auto reading = [this, path, step, volume = document_->volume(), memory = renderer_.host_budget(),
                          opening = desk_.openings](ProgressReporter& reporter) {
        const MeshCheck check = check_mesh(path, volume, memory, reporter.begin("reading " + short_name(path)));
        const auto read = std::make_shared<ReadFile>(ReadFile{.path = path,
                                                              .opening = opening,
                                                              .triangles = check.triangles,
                                                              .is_mesh = true,
                                                              .mesh_warning = check.warning});
        return Jobs::Completion([this, read, step] { go_on_with(read, step); });
    };
    start_reading("reading " + short_name(path), path, step, reading);
}

void FileTaker::read_annotation(Part part, const std::filesystem::path& path, Step step)
{
    const VolumeInfo volume = document_->volume();
    WorkFiles files{.volume_hash = document_->session.volume_hash,
                    .is_other_name = work_files(document_->session, volume).is_other_name,
                    .volume = volume};
    (part == Part::mask ? files.mask : part == Part::trace ? files.trace : files.density) = path;
    const auto read = std::make_shared<ReadFile>(
        ReadFile{.path = path, .opening = desk_.openings, .part = part, .groups = document_->session.groups});
    const auto reading = [this, volume, files, read, step](ProgressReporter&) {
        const auto found = std::make_shared<shvr::Document>(
            shvr::Document{.mask = Mask(volume.size), .trace = {}, .density = DensityField(volume.size, volume.type)});
        read->notes = shvr::load(*read->part, files, *found);
        read->found = found;
        read->looks = read->groups;
        if (*read->part == Part::mask) static_cast<void>(take_label_looks(read->path, read->looks));
        return Jobs::Completion([this, read, step] { go_on_with(read, step); });
    };
    start_reading("reading " + short_name(path), path, step, reading);
}

void FileTaker::go_on_with(std::shared_ptr<const ReadFile> read, Step step)
{
    if (!document_ || desk_.openings != read->opening)
        fail(read->path.string(), ": belongs to a volume that is no longer open");
    if (step == Step::load) return load(*read);
    if (step == Step::preview) {
        const bool is_wanted = has_preview() && preview_->path == read->path && preview_->is_being_read;
        if (is_wanted) show_preview(std::move(read));
        return;
    }
    to_preview_.push_back(std::move(read));
    show_next_preview();
}

/// Returns the changes of annotation that loading the file makes, without names and colours of groups.
std::vector<Change> FileTaker::changes_by(const ReadFile& read) const
{
    return changes_between(*read.part, document_->annotator.document(), *read.found);
}

void FileTaker::show_preview(std::shared_ptr<const ReadFile> read)
{
    LoadPreview preview{.path = read->path, .part = read->part};
    if (read->part) {
        const std::vector<Change> changes = changes_by(*read);
        const shvr::Document& present = document_->annotator.document();
        preview = preview_of(*read->part, present, *read->found, changes);
        preview.path = read->path;
        preview.notes = read->notes.losses;
        preview.notes.insert(preview.notes.end(), read->notes.remarks.begin(), read->notes.remarks.end());
        if (read->looks != read->groups) preview.notes.emplace_back("its names and colours of groups are taken, too");
    } else if (read->is_mesh) {
        preview.is_mesh = true;
        preview.changes = sentence("Its ", read->triangles, " triangles would be shown with the scan.");
        if (!read->mesh_warning.empty()) preview.notes.push_back(read->mesh_warning);
    } else {
        preview.changes = is_look(read->text, read->path.string())
                              ? "Names and colours of groups, the light and the transfer function would be replaced."
                              : "The transfer function would be replaced.";
    }
    preview_ = std::move(preview);
    preview_opening_ = read->opening;
    previewed_ = std::move(read);
}

/// Shows the files of a drop one after the other: what one changes depends on whether those before it were loaded.
void FileTaker::show_next_preview()
{
    while (!to_preview_.empty() && !has_preview()) {
        const std::shared_ptr<const ReadFile> next = to_preview_.front();
        to_preview_.pop_front();
        if (document_ && next->opening == desk_.openings) show_preview(next);
    }
}

/// Makes what was loaded into these sections of the settings a step of the history.
void FileTaker::record_loaded(std::initializer_list<std::string_view> sections)
{
    if (options_.is_script)
        document_->record_sections(sections);
    else
        others_.record_settings();
}

void FileTaker::load_transfer_function(const ReadFile& read)
{
    if (is_look(read.text, read.path.string())) {
        const NamedLook look = parse_look(read.text, read.path.stem().string(), read.path.string());
        others_.take_session(with_look(document_->session, look, document_->statistics));
        record_loaded({"transfer_function", "groups", "light"});
        return say("Loaded the look of " + read.path.string() + "; undo takes it back");
    }
    if (is_preset(read.text, read.path)) {
        Session after = document_->session;
        const TransferPreset preset = parse_transfer_preset(read.text, read.path.stem().string(), read.path.string());
        after.transfer_function = transfer_function_of(preset, document_->statistics);
        others_.take_session(std::move(after));
    } else {
        others_.set(Set{patch_of("transfer_function=" + read.text)});
    }
    record_loaded({"transfer_function"});
    say("Loaded the transfer function of " + read.path.string() + "; undo takes it back");
}

void FileTaker::add_mesh(const std::filesystem::path& path)
{
    const std::string name = mesh_file_name(document_->session, path);
    const std::vector<MeshLook>& meshes = document_->session.meshes;
    if (std::ranges::find(meshes, name, &MeshLook::file) != meshes.end())
        return say(path.string() + " is shown already; the panel Meshes lists it");
    if (meshes.size() == MAX_SESSION_MESHES)
        fail(path.string(), ": the scan has ", MAX_SESSION_MESHES,
             " meshes already; expected fewer, so remove one in the panel Meshes first");
    others_.set(edited(document_->session, [&](Session& s) { s.meshes.push_back({.file = name}); }));
    record_loaded({"meshes"});
    say(sentence("Shown: the mesh ", path.string(), "; undo takes it back"));
}

/// Adds the data that was read as one history step. For a mask, the step includes names and colours of groups that the
/// mask file states and the session lacks.
void FileTaker::load(const ReadFile& read)
{
    if (read.is_mesh) return add_mesh(read.path);
    if (!read.part) return load_transfer_function(read);
    const std::string path = read.path.string();
    const char* const name = name_of(*read.part);
    Annotator& annotator = document_->annotator;
    if (annotator.stroke_is_running()) fail(path, ": a stroke is being painted; load it again");
    others_.record_settings();
    std::vector<Change> changes = changes_by(read);
    if (read.looks != read.groups && document_->session.groups == read.groups) {
        Session after = document_->session;
        after.groups = read.looks;
        const SettingValues before = annotator.work().settings();
        const auto known = before.find("groups");
        changes.emplace_back(SettingChange{"groups", known == before.end() ? std::string() : known->second,
                                           lasting_settings(after).at("groups")});
    }
    const Command* const command =
        annotator.perform(sentence("loaded the ", name, " of ", short_name(path)), std::move(changes));
    if (!command) return say(sentence("The scan already has the ", name, " of ", path));
    if (*read.part == Part::mask) annotator.work().keep_header_of(read.path);
    others_.show_changes(*command);
    for (const std::string& loss : read.notes.losses) say(loss, Weight::warning);
    for (const std::string& remark : read.notes.remarks) say(remark);
    say(sentence("Loaded the ", name, " of ", path, "; undo takes it back"));
}

}  // namespace shvr::ui
