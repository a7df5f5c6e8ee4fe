// Saves a document: in place, in the background, or under other names.

#include <utility>

#include "engine/annotation/work/part_writer.h"
#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/session/annotation_files.h"
#include "engine/session/label_looks.h"
#include "engine/workbench/document/document.h"

namespace shvr::ui {

namespace {

std::filesystem::path beside(const std::filesystem::path& session_file, const char* extension)
{
    return std::filesystem::path(session_file).replace_extension(extension);
}

/// Returns the session for a save as `path`, with its annotation files named after it.
Session renamed(Session session, const std::filesystem::path& path)
{
    name_annotation(session, path);
    return session;
}

/// Checks a path for a new session. Fails if it is not a valid name for a session, or if it exists already.
std::filesystem::path new_session_path(const std::filesystem::path& path)
{
    if (path.extension() != ".json") fail(path.string(), ": is no name for a session; expected one that ends in .json");
    const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        fail(path.string(), ": cannot be created, since ", folder.string(), " is no folder; expected one that exists");
    for (const char* extension : SESSION_EXTENSIONS)
        if (is_there(beside(path, extension)))
            fail(beside(path, extension).string(), ": exists already; expected a name that is free");
    return std::filesystem::absolute(path).lexically_normal();
}

std::filesystem::path free_copy_path(const std::filesystem::path& session_file)
{
    const std::string stem = beside(session_file, "").string() + "-copy";
    for (int number = 1;; ++number) {
        const std::filesystem::path path = number == 1 ? stem + ".json" : sentence(stem, number, ".json");
        const auto is_taken = [&](const char* extension) { return is_there(beside(path, extension)); };
        if (std::ranges::none_of(SESSION_EXTENSIONS, is_taken)) return path;
    }
}

}  // namespace

std::shared_ptr<Document::Saving> Document::begin_save(Parts parts)
{
    if (only_looks())
        throw JournalTaken(sentence(shown_name(), ": is not saved, since ", why_only_looks(),
                                    !remote.empty()   ? "; expected an import, or a copy of the session to work on"
                                    : outside.empty() ? "; expected it to be closed there, or a copy to work on"
                                                      : "; expected a choice: there, or a copy to work on"));
    std::shared_ptr<Saving> saving(new Saving);
    if (parts != Parts::session) name_sparse_files(parts, *saving);
    if (parts == Parts::work) {
        saving->work_ = annotator.work().begin_save(label_looks(session.groups, annotator.document().mask));
        return saving;
    }
    if (parts == Parts::all) {
        if (session.density_path.empty() && annotator.document().density.voxels() > 0)
            session.density_path = offsets_beside(session.mask_path);
        name_trace();
        annotator.work().name_files(session.mask_path, session.trace_path, session.density_path);
        keep_settings();
        saving->work_ = annotator.work().begin_save(label_looks(session.groups, annotator.document().mask));
    }
    saving->session_path_ = session_path;
    saving->text_ = to_text(saved_session(), std::filesystem::absolute(session_path).parent_path());
    saving->text_there_ = session_text_;
    saving->edits_ = edits();
    saving->place_ = place();
    return saving;
}

/// Earlier versions stored a byte for every voxel of a project. When such a project is saved, only its painted bricks
/// are written, to files with new names; the old files stay.
void Document::name_sparse_files(Parts parts, Saving& saving)
{
    const bool is_named_here =
        std::ranges::any_of(overridden_, [](const std::string& setting) { return setting.starts_with("annotation."); });
    if (is_named_here || !session_text_ || !annotator.work().disputes().empty()) return;
    const std::optional<AnnotationNames> names = sparse_names(session, session_path);
    if (!names) return;
    session.mask_path = names->mask;
    session.density_path = names->density;
    if (parts == Parts::all) return;
    annotator.work().name_files(session.mask_path, session.trace_path, session.density_path);
    saving.names_ = names;
    saving.names_path_ = session_path;
}

/// Updates only the names of annotation files in the current session file, even if another program has just written it.
void Document::Saving::write_names()
{
    const std::optional<std::string> there = text_of_session(names_path_);
    if (!there) return;  // without a session file, default names apply: the same that a new project uses
    text_ = with_names(*there, *names_, names_path_);
    write_file_atomically(names_path_, std::as_bytes(std::span(text_)));
}

/// Writes the session. If another program changed the file meanwhile, keeps its version in a copy, named in the notice.
void Document::Saving::write_session()
{
    std::optional<KeptFile> kept;
    if (const std::optional<std::string> there = text_of_session(session_path_); there && there != text_there_)
        kept.emplace(session_path_);
    write_file_atomically(session_path_, std::as_bytes(std::span(text_)));
    if (kept && kept->old())
        notice_ = {
            sentence(session_path_.string(), ": was written by another program since it was opened; it is kept as ",
                     kept->old()->string(), ", and what is saved is this window's"),
            true};
    has_session_ = true;
}

void Document::Saving::write(ProgressReporter& reporter)
{
    const Progress progress =
        reporter.begin(session_path_.empty() ? "saving" : "saving " + session_path_.filename().string());
    if (as_)
        as_->write([this] { write_session(); }, progress);
    else if (work_ && names_)
        work_->write({}, progress, [this] { write_names(); });
    else if (work_)
        work_->write(
            session_path_.empty() ? std::function<void()>() : [this] { write_session(); }, progress);
    else
        write_session();
    is_written_ = true;
}

Work::Saved Document::end_save(Saving& saving)
{
    Work::Saved saved;
    if (saving.work_) saved = annotator.work().end_save(*saving.work_);
    if (saving.as_) saved = annotator.work().end_save_as(*saving.as_);
    if (saving.as_ && saving.is_written_) {
        session = renamed(std::move(session), saving.session_path_);
        session_path = saving.session_path_;
        overridden_.clear();  // the new file also holds settings that were made for this run only
    }
    if (saving.notice_) saved.notices.push_back(*saving.notice_);
    if (saving.has_session_ || (saving.names_ && !saving.text_.empty())) session_text_ = saving.text_;
    if (!saving.is_written_ || saving.session_path_.empty()) return saved;
    saved_edits_ = saving.edits_;
    edits_are_saved_.reset();
    saved_place_ = saving.place_;
    return saved;
}

bool Document::has_view_to_keep() const
{
    if (only_looks() || !annotator.work().disputes().empty()) return false;
    const bool is_kept = saved_place_ == place();
    std::error_code ignored;
    return !is_kept && overridden_.empty() && is_saved() && std::filesystem::is_regular_file(session_path, ignored);
}

std::function<std::filesystem::path()> Document::copier(const std::filesystem::path& path) const
{
    if (!path.empty()) new_session_path(path);  // refused at once
    return [session = saved_session(), at = session_path, path, volume = volume(),
            copy = annotator.work().copier(label_looks(session.groups, annotator.document().mask))] {
        const std::filesystem::path to = path.empty() ? free_copy_path(at) : new_session_path(path);
        const Session copied = renamed(session, to);
        copy(work_files(copied, volume));
        const std::string text = to_text(copied, std::filesystem::absolute(to).parent_path());
        write_file_atomically(to, std::as_bytes(std::span(text)));
        return to;
    };
}

std::shared_ptr<Document::Saving> Document::begin_save_as(const std::filesystem::path& path)
{
    const std::filesystem::path next = new_session_path(path);
    keep_settings();
    const Session moved = renamed(saved_session(), next);
    std::shared_ptr<Saving> saving(new Saving);
    saving->as_ = annotator.work().begin_save_as(work_files(moved, volume()),
                                                 label_looks(session.groups, annotator.document().mask), next);
    saving->session_path_ = next;
    saving->text_ = to_text(moved, next.parent_path());
    saving->edits_ = renamed(edits(), next);
    saving->place_ = place();
    return saving;
}

/// Names a new file for a trace that was read from a format other than GraphML, since no other format can store a whole
/// trace. The original file stays unchanged.
void Document::name_trace()
{
    if (annotator.work().trace_is_saved()) return;
    if (session.trace_path.empty()) {
        session.trace_path = session_path;
        session.trace_path.replace_extension(".graphml");
    } else if (session.trace_path.extension() != ".graphml") {
        const std::filesystem::path stem = std::filesystem::path(session.trace_path).replace_extension();
        session.trace_path = stem.string() + ".graphml";
        for (int number = 2; std::filesystem::exists(session.trace_path); ++number)
            session.trace_path = sentence(stem.string(), "-", number, ".graphml");
    }
}

}  // namespace shvr::ui
