#include "ui/panels/dialogs/file_chooser.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/error.h"
#include "ui/panels/imgui_keys.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace fs = std::filesystem;

namespace {

/// The last frame in which any chooser was open, and the last frame in which any chooser was reading a folder.
int open_in_frame = -10, reading_in_frame = -10;

bool is_recent(int frame)
{
    return ImGui::GetFrameCount() - frame <= 1;
}

bool is_pressed(ImGuiKey key, bool repeats = true)
{
    return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), repeats);
}

bool enter_is_pressed()
{
    return is_pressed(ImGuiKey_Enter, false) || is_pressed(KEYPAD_ENTER, false);
}

std::string with_slash(const fs::path& folder)
{
    std::string text = folder.string();
    return text.ends_with('/') ? text : text + "/";
}

/// Completes the path in a field on Tab, unless the file system takes too long to answer.
struct Completion {
    fs::path folder;
    bool has_answered = true;
};
int complete(ImGuiInputTextCallbackData* data)
{
    constexpr std::chrono::milliseconds SOON{100};
    auto& completion = *static_cast<Completion*>(data->UserData);
    Asked<std::string> asked([typed = std::string(data->Buf, size_t(data->BufTextLen)), folder = completion.folder] {
        return completed(typed, folder);
    });
    const std::optional<std::string> text = asked.take(SOON);
    completion.has_answered = text.has_value();
    if (!text) return 0;
    data->DeleteChars(0, data->BufTextLen);
    data->InsertChars(0, text->c_str());
    return 0;
}

}  // namespace

bool FileChooser::has_keys()
{
    return open_in_frame == ImGui::GetFrameCount();
}

bool FileChooser::is_busy()
{
    return is_recent(reading_in_frame);
}

void FileChooser::ask(const fs::path& begin, std::vector<Place> places)
{
    places_ = std::move(places);
    is_asked_for_ = true;
    closes_ = false;
    failure_.clear();
    forget_questions();
    const std::string kept = text_;
    if (begin.empty() && !list_.folder().empty()) {
        enter(list_.folder());  // again, since it may have changed
        text_ = kept;
    } else {
        const fs::path whole = begin.empty() ? home_folder() : fs::absolute(begin).lexically_normal();
        enter(whole.parent_path());
        text_ = whole.string();
        follow(whole);
        suggest_only_file();
    }
    if (const fs::path path = typed_path(text_, list_.folder()); path.parent_path() == list_.folder())
        wanted_name_ = path.filename().string();
}

/// Selects the file of the listed folder if it is the only one that SHVR opens there, so that Enter opens it.
void FileChooser::suggest_only_file()
{
    if (question_.wanted != Wanted::scan || text_ != with_slash(list_.folder()) || list_.is_reading()) return;
    const size_t size = list_.size();  // files come after folders
    if (size == 0 || list_.at(size - 1).is_folder || (size > 1 && !list_.at(size - 2).is_folder)) return;
    select(size - 1);
}

void FileChooser::ask_again(const fs::path& path, std::vector<Place> places, std::string failure)
{
    ask({}, std::move(places));
    if (!is_typed_address(path.string())) {
        enter(path.parent_path());
        wanted_name_ = path.filename().string();
    }
    text_ = path.string();
    failure_ = std::move(failure);
}

void FileChooser::enter(const fs::path& folder)
{
    forget_questions();
    list_.enter(folder);
    text_ = with_slash(folder);
    failure_.clear();
    wanted_name_.clear();
    selected_.reset();
    scrolls_ = true;
    ++field_number_;
}

void FileChooser::forget_questions()
{
    verdict_ = {};
    is_folder_ = {};
}

/// Lists `folder` as soon as the file system has confirmed that it is a folder.
void FileChooser::follow(const fs::path& folder)
{
    followed_ = folder;
    is_folder_ = Asked<bool>([folder] {
        std::error_code ignored;
        return fs::is_directory(folder, ignored);
    });
    settle(AT_ONCE);
}

void FileChooser::select(size_t row)
{
    forget_questions();
    selected_ = row;
    text_ = with_slash(list_.folder()) + list_.at(row).name;
    failure_.clear();
    scrolls_ = true;
    ++field_number_;
}

/// Accepts the typed path, enters it, or states why it is refused, once the file system has answered.
void FileChooser::accept(const std::string& typed, bool enters_folders)
{
    forget_questions();
    failure_.clear();
    if (is_typed_address(typed)) return accept_address(typed);
    judged_ = typed_path(typed, list_.folder());
    verdict_ = Asked<Verdict>([path = judged_, wanted = question_.wanted, enters_folders] {
        return verdict_on(path, wanted, enters_folders);
    });
    settle(AT_ONCE);
}

/// Accepts a typed address, without its query, or states why it is refused. Its server is asked when it is opened.
void FileChooser::accept_address(const std::string& typed)
{
    try {
        text_ = typed_address(typed);
        if (question_.wanted != Wanted::scan)
            fail(text_, ": is an address; expected a file or a folder on this machine");
        accepted_ = text_;
    } catch (const Error& error) {
        failure_ = error.what();
        field_wants_keys_ = true;
    }
}

/// Does what waited for an answer.
void FileChooser::settle(std::chrono::milliseconds patience)
{
    if (const std::optional<bool> is_folder = is_folder_.take(patience); is_folder && *is_folder) {
        list_.enter(followed_);
        if (text_ == followed_.string()) text_ = with_slash(followed_);
        selected_.reset();
        wanted_name_.clear();
        scrolls_ = true;
    }
    const std::optional<Verdict> verdict = verdict_.take(patience);
    if (!verdict) return;
    if (verdict->enters) return enter(judged_);
    failure_ = verdict->failure;
    if (!failure_.empty()) {
        field_wants_keys_ = true;
        return;
    }
    // Enters the folder of the typed path, so that the dialog begins there when it is opened again.
    if (judged_.parent_path() != list_.folder()) {
        enter(judged_.parent_path());
        wanted_name_ = judged_.filename().string();
    }
    text_ = judged_.string();
    accepted_ = judged_;
}

/// Returns a sentence that explains the present wait, if it is long enough to be noticed; otherwise empty.
std::string FileChooser::waits_in_words()
{
    constexpr double NOTICED_S = 0.5;
    const bool waits_for_names = list_.is_reading() && list_.size() == 0;
    if (!verdict_.is_pending() && !is_folder_.is_pending() && !waits_for_names) {
        waiting_since_.reset();
        return {};
    }
    if (!waiting_since_) waiting_since_ = ImGui::GetTime();
    const double waited_s = ImGui::GetTime() - *waiting_since_;
    if (waited_s < NOTICED_S) return {};
    const fs::path& path = verdict_.is_pending() ? judged_ : is_folder_.is_pending() ? followed_ : list_.folder();
    return sentence("Waiting for ", path.string(), ", which has not answered for ", int(waited_s),
                    " s. Choose another place, or cancel.");
}

std::optional<fs::path> FileChooser::draw()
{
    if (is_asked_for_) ImGui::OpenPopup(question_.title);
    if (std::exchange(is_asked_for_, false)) field_wants_keys_ = true;
    const ImGuiViewport& screen = *ImGui::GetMainViewport();
    const float font = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(screen.GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    ImGui::SetNextWindowSize(
        {std::min(58.0f * font, 0.94f * screen.WorkSize.x), std::min(36.0f * font, 0.9f * screen.WorkSize.y)},
        ImGuiCond_Appearing);
    accepted_.reset();
    is_open_ = begin_dialog(question_.title, ImGuiWindowFlags_NoSavedSettings);
    if (!is_open_) return std::nullopt;
    auto result = contents();
    if (is_open_) open_in_frame = ImGui::GetFrameCount();
    ImGui::EndPopup();
    return result;
}

/// Takes the answers that the file system has given since the last frame.
void FileChooser::take_answers()
{
    list_.show(all_files_, hidden_);
    list_.read_on();
    settle();
    if (list_.is_waiting() || verdict_.is_pending() || is_folder_.is_pending())
        reading_in_frame = ImGui::GetFrameCount();
    if (!wanted_name_.empty()) {
        if (const auto row = list_.row_of(wanted_name_)) {
            selected_ = row;
            scrolls_ = true;
            wanted_name_.clear();
        }
    }
    // Rows move while a folder is read.
    if (selected_ && *selected_ >= list_.size()) selected_.reset();
}

std::optional<fs::path> FileChooser::contents()
{
    want_glyphs(text_);
    want_glyphs(failure_);
    take_answers();
    path_field();
    keys();
    const float below = 3.0f * ImGui::GetFrameHeightWithSpacing() + ImGui::GetStyle().ItemSpacing.y;
    const float height = std::max(ImGui::GetContentRegionAvail().y - below, 4.0f * ImGui::GetFrameHeight());
    place_list();
    ImGui::SameLine();
    file_table(height);
    const std::string waits = waits_in_words();
    note_line(!waits.empty() ? waits : failure_.empty() ? list_.failure() : failure_);
    filter_row();

    const ImVec2 button{7.0f * ImGui::GetFontSize(), 0.0f};
    if (ImGui::Button(question_.verb, button)) accept(text_, false);
    ImGui::SameLine();
    const bool cancelled = ImGui::Button("Cancel", button) || is_pressed(ImGuiKey_Escape, false) || closes_;
    if (!accepted_ && !cancelled) return std::nullopt;
    closes_ = is_open_ = false;
    ImGui::CloseCurrentPopup();
    return accepted_;
}

/// Draws the line below the list: the reason why a path or a folder is refused or, without one, the note.
void FileChooser::note_line(const std::string& failure)
{
    if (failure.empty()) {
        ImGui::TextDisabled("%s", question_.note.c_str());
    } else {
        ImGui::PushStyleColor(ImGuiCol_Text, WARNING);
        ImGui::TextUnformatted(failure.c_str());
        ImGui::PopStyleColor();
    }
}

/// Draws the choice of which names are listed, and the number of listed names.
void FileChooser::filter_row()
{
    bool changed = false;
    const char* const filters[] = {"What SHVR opens", "All files"};
    int filter = all_files_;
    ImGui::SetNextItemWidth(12.0f * ImGui::GetFontSize());
    if (ImGui::Combo("##filter", &filter, filters, 2)) changed = true, all_files_ = filter == 1;
    ImGui::SameLine();
    changed |= ImGui::Checkbox("Hidden", &hidden_);
    if (changed) {
        wanted_name_ = selected_ ? list_.at(*selected_).name : std::string();
        selected_.reset();
    }
    ImGui::SameLine();
    const bool is_empty = list_.size() == 0 && list_.left_out() == 0 && !list_.is_reading();
    const std::string count = is_empty ? "nothing is in this folder"
                                       : sentence(list_.size(), " shown, ", list_.left_out(), " left out",
                                                  list_.is_reading() ? ", reading..." : "");
    ImGui::TextDisabled("%s", count.c_str());
}

void FileChooser::path_field()
{
    if (ImGui::Button("Up")) enter(list_.folder().parent_path());
    hint("to the folder around this one (Backspace in the list)");
    ImGui::SameLine();
    ImGui::PushID(field_number_);
    ImGui::SetNextItemWidth(-1.0f);
    field_keys_.before_field(std::exchange(field_wants_keys_, false));
    Completion completion{list_.folder()};
    const bool entered =
        ImGui::InputText("##path", &text_,
                         ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackCompletion |
                             (question_.wanted == Wanted::new_file ? 0 : ImGuiInputTextFlags_AutoSelectAll),
                         complete, &completion);
    field_keys_.after_field();
    field_has_keys_ = ImGui::IsItemActive() || entered || field_keys_.are_awaited();
    if (!completion.has_answered) failure_ = "The path cannot be completed: its folder does not answer";
    if (ImGui::IsItemEdited()) {
        failure_.clear();
        forget_questions();
        follow_typed();
    }
    ImGui::PopID();
    if (entered) accept(text_, true);
}

/// While the user types an absolute path, lists the folder of that path once the slash after the folder is typed.
void FileChooser::follow_typed()
{
    if (!text_.ends_with('/') || !(text_.starts_with('/') || text_.starts_with('~'))) return;
    if (const fs::path folder = typed_path(text_, list_.folder()); folder != list_.folder()) follow(folder);
}

/// Up and Down move from the field into the list. There, letters jump, Backspace goes up, and / or ~ begins a path.
void FileChooser::keys()
{
    const auto step = [&](int64_t rows) {
        if (list_.size() == 0) return;
        const int64_t at = selected_ ? int64_t(*selected_) + rows : rows > 0 ? 0 : int64_t(list_.size()) - 1;
        select(size_t(std::clamp<int64_t>(at, 0, int64_t(list_.size()) - 1)));
    };
    if (is_pressed(ImGuiKey_DownArrow)) return step(1);
    if (is_pressed(ImGuiKey_UpArrow)) return step(-1);
    if (is_pressed(ImGuiKey_PageDown)) return step(12);
    if (is_pressed(ImGuiKey_PageUp)) return step(-12);
    if (field_has_keys_ || ImGui::IsAnyItemActive()) return;
    if (is_pressed(ImGuiKey_Home)) return step(-int64_t(list_.size()));
    if (is_pressed(ImGuiKey_End)) return step(int64_t(list_.size()));
    if (is_pressed(ImGuiKey_Backspace)) return enter(list_.folder().parent_path());
    if (enter_is_pressed()) return accept(text_, true);
    for (const ImWchar typed : ImGui::GetIO().InputQueueCharacters) {
        if (field_wants_keys_ || typed == '/' || typed == '~') {
            if (!field_wants_keys_) text_.clear();
            field_keys_.type(typed);
            field_wants_keys_ = true;
        } else if (typed > ' ' && typed < 127) {
            const char text = char(typed);
            if (const auto row = list_.row_beginning({&text, 1}, selected_ ? *selected_ + 1 : 0)) select(*row);
        }
    }
}

void FileChooser::place_list()
{
    const float below = 3.0f * ImGui::GetFrameHeightWithSpacing() + ImGui::GetStyle().ItemSpacing.y;
    ImGui::BeginChild("places", {11.0f * ImGui::GetFontSize(), -below});
    for (size_t i = 0; i < places_.size(); ++i) {
        ImGui::PushID(int(i));
        want_glyphs(places_[i].folder.native());
        const std::string fitting = shortened(verbatim(places_[i].name), ImGui::GetContentRegionAvail().x);
        if (ImGui::Selectable(fitting.c_str(), places_[i].folder == list_.folder())) enter(places_[i].folder);
        hint(places_[i].folder.c_str());
        ImGui::PopID();
    }
    ImGui::EndChild();
}

void FileChooser::file_table(float height)
{
    const ImGuiTableFlags flags =
        ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_Resizable | ImGuiTableFlags_BordersInnerV;
    ImGui::PushID(list_.folder().c_str());  // gives each folder a scroll position of its own, which begins at the top
    if (ImGui::BeginTable("files", 4, flags, {0.0f, height})) {
        const float font = ImGui::GetFontSize();
        ImGui::TableSetupScrollFreeze(0, 1);
        ImGui::TableSetupColumn("Name", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableSetupColumn("Kind", ImGuiTableColumnFlags_WidthFixed, 9.5f * font);
        ImGui::TableSetupColumn("Size", ImGuiTableColumnFlags_WidthFixed, 4.5f * font);
        ImGui::TableSetupColumn("Changed", ImGuiTableColumnFlags_WidthFixed, 9.5f * font);
        ImGui::TableHeadersRow();
        const float row_height = ImGui::GetTextLineHeight() + 2.0f * ImGui::GetStyle().CellPadding.y;
        if (std::exchange(scrolls_, false) && selected_)
            ImGui::SetScrollY(std::max(0.0f, float(*selected_) * row_height - 0.4f * height));
        std::optional<size_t> clicked, opened;
        ImGuiListClipper clipper;
        clipper.Begin(int(list_.size()), row_height);
        while (clipper.Step()) {
            for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
                const size_t row = size_t(i);
                const FileList::Entry& entry = list_.at(row);
                const FileDetails& details = list_.details(row);
                ImGui::TableNextRow();
                ImGui::TableNextColumn();
                ImGui::PushID(i);
                const std::string name = entry.name + (entry.is_folder ? "/" : "");
                want_glyphs(name);
                if (ImGui::Selectable("##row", selected_ == row,
                                      ImGuiSelectableFlags_SpanAllColumns | ImGuiSelectableFlags_AllowDoubleClick))
                    (ImGui::IsMouseDoubleClicked(0) ? opened : clicked) = row;
                ImGui::SameLine(0.0f, 0.0f);
                const std::string fitting = shortened(name, ImGui::GetContentRegionAvail().x);
                ImGui::TextUnformatted(fitting.c_str());
                if (fitting != name) hint(name.c_str());
                ImGui::TableNextColumn();
                ImGui::TextDisabled("%s", details.kind_text.c_str());
                ImGui::TableNextColumn();
                ImGui::TextDisabled("%s", details.bytes ? size_text(*details.bytes).c_str() : "");
                ImGui::TableNextColumn();
                ImGui::TextDisabled("%s", details.changed.c_str());
                ImGui::PopID();
            }
        }
        ImGui::EndTable();
        if (clicked || opened) {
            select(clicked ? *clicked : *opened);
            scrolls_ = false;
        }
        if (opened) accept(text_, true);
    }
    ImGui::PopID();
}

}  // namespace shvr::ui
