#include "engine/workbench/lists/bug_report.h"

#include <algorithm>
#include <ctime>

#include "engine/base/error.h"
#include "engine/workbench/lists/recent_actions.h"
#include "engine/workbench/models/hand_view.h"

namespace shvr::ui {

namespace {

constexpr size_t MAX_MESSAGES_IN_REPORT = 50;

std::string counted(uint64_t count, const char* what)
{
    return count == 0 ? std::string() : sentence(count, ' ', what, count == 1 ? "" : "s");
}

std::string line_of(const Message& message)
{
    const std::string word = word_of(message.weight);
    return sentence(time_in_words(message), ' ', word, word.empty() ? "" : ": ", message.text, '\n');
}

std::string size_in_words(const Model& model)
{
    const Size3 size = model.volume.size;
    return sentence(size.x, " x ", size.y, " x ", size.z, " voxels");
}

}  // namespace

const char* word_of(Weight weight)
{
    switch (weight) {
        case Weight::done: return "";
        case Weight::warning: return "warning";
        case Weight::error: return "error";
    }
    return "";
}

std::string time_in_words(const Message& message)
{
    std::tm local{};
    char text[16] = "";
    if (localtime_r(&message.at, &local)) std::strftime(text, sizeof text, "%H:%M:%S", &local);
    return text;
}

std::string unread_in_words(const MessageLog& messages)
{
    const std::string errors = counted(messages.unread(Weight::error), "error"),
                      warnings = counted(messages.unread(Weight::warning), "warning");
    return errors + (errors.empty() || warnings.empty() ? "" : ", ") + warnings;
}

std::string bug_report(const Model& model)
{
    std::string text =
        sentence("- SHVR ", model.version.empty() ? "(unknown version)" : model.version,
                 "\n- device: ", model.gpu_name.empty() ? "(unknown)" : model.gpu_name,
                 "\n- session: ", model.is_open ? model.session_path.string() + ", " + size_in_words(model) : "(none)");
    if (model.hand && !model.hand->recording.empty())
        text += "\n- stylus recording, to be attached: " + model.hand->recording.string();
    text += "\n\nThe last actions, the newest at the bottom:\n```\n";
    if (model.recent)
        for (const std::string& line : model.recent->lines()) text += line + '\n';
    text += "```\n\nThe last messages:\n```\n";
    const std::deque<Message>& all = model.messages.all();
    for (size_t i = all.size() - std::min(all.size(), MAX_MESSAGES_IN_REPORT); i < all.size(); ++i)
        text += line_of(all[i]);
    return text + "```\n";
}

}  // namespace shvr::ui
