#include "tools/cli/about/manual.h"

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr::cli {

namespace {

/// A command's table, as --help prints it.
struct Entry {
    std::vector<std::string> words;  ///< {"shvr", "haptics", "replay"}
    const CLI::App* app = nullptr;
    std::vector<const CLI::App*> commands;

    std::string joined(char between) const
    {
        std::string text;
        for (const std::string& word : words) text += (text.empty() ? "" : std::string(1, between)) + word;
        return text;
    }
};

bool is_shown(const CLI::App* command)
{
    return !command->get_group().empty();
}

void collect(const CLI::App& app, std::vector<std::string> words, std::vector<Entry>& entries)
{
    words.push_back(app.get_name());
    const std::vector<const CLI::App*> commands = app.get_subcommands(is_shown);
    entries.push_back({words, &app, commands});
    for (const CLI::App* command : commands) collect(*command, words, entries);
}

std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional)
{
    return app.get_options([&](const CLI::Option* option) {
        return !option->get_group().empty() && option->get_positional() == positional;
    });
}

/// Returns the kind of value: "INT in [0 - 23]"; of "files|journal:{files,journal}", only the part before the colon.
std::string value_name(const CLI::Option& option)
{
    if (option.get_expected_max() == 0 || option.get_type_size() == 0) return {};
    const std::string name = option.get_type_name();
    return name.substr(0, name.find(":{"));
}

/// Returns the values that an option accepts; empty if it accepts any.
std::vector<std::string> choices_of(const CLI::Option& option)
{
    const std::string name = option.get_type_name();
    const size_t from = name.find('{'), to = name.rfind('}');
    std::vector<std::string> choices;
    if (from == name.npos || to == name.npos) return choices;
    std::string_view rest = std::string_view(name).substr(from + 1, to - from - 1);
    while (!rest.empty()) {
        const size_t comma = rest.find(',');
        choices.emplace_back(trimmed(rest.substr(0, comma)));
        rest = comma == rest.npos ? "" : rest.substr(comma + 1);
    }
    return choices;
}

std::vector<std::string> names_of(const CLI::Option& option)
{
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames()) names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
    return names;
}

// ---- Manual pages ---------------------------------------------------------------------------------------------------

/// Escapes a text for troff: hyphens become minus signs, and leading dots and quotes do not start macros.
std::string troff(std::string_view text)
{
    std::string escaped;
    for (const char c : text) {
        const bool starts_line = escaped.empty() || escaped.back() == '\n';
        if (c == '\\')
            escaped += "\\e";
        else if (c == '-')
            escaped += "\\-";
        else if ((c == '.' || c == '\'') && starts_line)
            escaped += std::string("\\&") + c;
        else
            escaped += c;
    }
    return escaped;
}

std::string page_options(const CLI::App& app)
{
    std::string text;
    for (const bool positional : {true, false})
        for (const CLI::Option* option : options_of(app, positional)) {
            std::string names = positional ? option->get_name() : "";
            for (const std::string& name : names_of(*option)) names += (names.empty() ? "" : ", ") + name;
            const std::string value = positional ? "" : value_name(*option);
            text += ".TP\n\\fB" + troff(names) + "\\fR" + (value.empty() ? "" : " \\fI" + troff(value) + "\\fR") +
                    "\n" + troff(option->get_description()) + (option->get_required() ? " (required)" : "") + "\n";
        }
    return text;
}

/// Formats the footer's paragraphs. Lines that begin with a space are examples, and stay as they are.
std::string page_footer(const std::string& footer)
{
    std::string text;
    bool is_example = false;
    std::string_view rest = footer;
    while (!rest.empty()) {
        const std::string_view line = take_line(rest);
        if (line.empty()) {
            text += is_example ? "" : ".PP\n";
            continue;
        }
        if (line.starts_with(' ') != is_example) text += is_example ? ".EE\n" : ".PP\n.EX\n";
        is_example = line.starts_with(' ');
        text += troff(line) + "\n";
    }
    return text + (is_example ? ".EE\n" : "");
}

ManualFile page_of(const Entry& entry, const std::vector<Entry>& entries, const std::string& version)
{
    const std::string name = entry.joined('-');
    const CLI::App& app = *entry.app;
    std::string title = name;
    std::ranges::transform(title, title.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; });
    std::string text = ".TH " + troff(title) + " 1 \"\" \"SHVR " + troff(version) + "\" \"SHVR\"\n.SH NAME\n" +
                       troff(name) + " \\- " + troff(app.get_description()) + "\n.SH SYNOPSIS\n\\fB" +
                       troff(entry.joined(' ')) + "\\fR [\\fIOPTIONS\\fR]";
    for (const CLI::Option* option : options_of(app, true)) text += " \\fI" + troff(option->get_name()) + "\\fR";
    text += std::string(entry.commands.empty() ? "" : " \\fICOMMAND\\fR") + "\n.SH OPTIONS\n" + page_options(app);
    if (!entry.commands.empty()) text += ".SH COMMANDS\n";
    for (const CLI::App* command : entry.commands)
        text += ".TP\n\\fB" + troff(command->get_name()) + "\\fR\n" + troff(command->get_description()) + "\n";
    if (const std::string footer = app.get_footer(); !footer.empty()) text += ".SH NOTES\n" + page_footer(footer);
    text +=
        ".SH EXIT STATUS\n0: done. 1: a file, device or system prevented it. 2: wrong usage. 3: a comparison or "
        "gate failed.\n.SH SEE ALSO\n";
    std::string others;
    for (const Entry& other : entries)
        if (other.words.size() <= 2 && other.words != entry.words)
            others += (others.empty() ? "" : ",\n") + (".BR " + troff(other.joined('-')) + " (1)");
    // A troff macro takes the rest of its line as arguments, so the comma has to be one of its arguments.
    for (size_t at = 0; (at = others.find(" (1),\n", at)) != others.npos; ++at) others.replace(at, 6, " (1),\n");
    return {"man/man1/" + name + ".1", text + others + "\n"};
}

// ---- Completions ----------------------------------------------------------------------------------------------------

std::string single_quoted(std::string_view text)
{
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
    return result + "'";
}

std::string words_of(const Entry& entry)
{
    std::string words;
    for (const CLI::App* command : entry.commands) words += command->get_name() + ' ';
    for (const CLI::Option* option : options_of(*entry.app, false))
        for (const std::string& name : names_of(*option)) words += name + ' ';
    if (!words.empty()) words.pop_back();
    return words;
}

ManualFile bash_of(const std::vector<Entry>& entries)
{
    std::string text =
        "# Completion of shvr for bash.\n_shvr()\n{\n    local word=${COMP_WORDS[COMP_CWORD]} "
        "before=${COMP_WORDS[COMP_CWORD-1]}\n"
        "    local command=shvr known=' ' i\n    COMPREPLY=()\n";
    for (const Entry& entry : entries)
        if (entry.words.size() > 1) text += "    known+=" + single_quoted(entry.joined('-') + " ") + "\n";
    text +=
        "    for ((i = 1; i < COMP_CWORD; i++)); do\n"
        "        [[ $known == *\" $command-${COMP_WORDS[i]} \"* ]] && command+=-${COMP_WORDS[i]}\n    done\n"
        "    case \"$command $before\" in\n";
    for (const Entry& entry : entries)
        for (const CLI::Option* option : options_of(*entry.app, false)) {
            std::string choices;
            for (const std::string& choice : choices_of(*option)) choices += (choices.empty() ? "" : " ") + choice;
            if (choices.empty()) continue;
            for (const std::string& name : names_of(*option))
                text += "        " + single_quoted(entry.joined('-') + " " + name) +
                        ") mapfile -t COMPREPLY < <(compgen -W " + single_quoted(choices) +
                        " -- \"$word\"); return ;;\n";
        }
    text += "    esac\n    case $command in\n";
    for (const Entry& entry : entries)
        text += "        " + entry.joined('-') + ") mapfile -t COMPREPLY < <(compgen -W " +
                single_quoted(words_of(entry)) + " -- \"$word\") ;;\n";
    text += "    esac\n    # Without a match, names of files.\n}\ncomplete -o default -F _shvr shvr\n";
    return {"bash-completion/completions/shvr", text};
}

/// Escapes a description for zsh's _arguments, in which brackets and colons are special.
std::string zsh_text(std::string_view text)
{
    std::string escaped;
    for (const char c : text)
        escaped += (c == '[' || c == ']' || c == ':' || c == '\\') ? std::string("\\") + c : std::string(1, c);
    return escaped;
}

std::string zsh_function(const Entry& entry)
{
    std::string text = "_" + entry.joined('_') + "()\n{\n";
    if (!entry.commands.empty()) {
        text += "    local -a commands=(\n";
        for (const CLI::App* command : entry.commands)
            text += "        " + single_quoted(command->get_name() + ":" + command->get_description()) + "\n";
        text += "    )\n";
    }
    text += "    local context state line\n    _arguments -C";
    for (const CLI::Option* option : options_of(*entry.app, false))
        for (const std::string& name : names_of(*option)) {
            std::string values;
            for (const std::string& choice : choices_of(*option)) values += (values.empty() ? "" : " ") + choice;
            std::string spec = name + "[" + zsh_text(option->get_description()) + "]";
            if (const std::string value = value_name(*option); !value.empty())
                spec += ":" + zsh_text(value) + ":" + (values.empty() ? "_files" : "(" + values + ")");
            text += " \\\n        " + single_quoted(spec);
        }
    if (entry.commands.empty()) return text + " \\\n        '*:file:_files'\n}\n";
    text +=
        " \\\n        '1:command:->command' '*::argument:->argument'\n    case $state in\n"
        "        command) _describe command commands ;;\n        argument)\n            case $line[1] in\n";
    for (const CLI::App* command : entry.commands)
        text +=
            "                " + command->get_name() + ") _" + entry.joined('_') + "_" + command->get_name() + " ;;\n";
    return text + "            esac ;;\n    esac\n}\n";
}

ManualFile zsh_of(const std::vector<Entry>& entries)
{
    std::string text = "#compdef shvr\n# Completion of shvr for zsh.\n";
    for (const Entry& entry : entries) text += zsh_function(entry);
    return {"zsh/site-functions/_shvr", text + "_shvr \"$@\"\n"};
}

ManualFile fish_of(const std::vector<Entry>& entries)
{
    std::string text = "# Completion of shvr for fish.\n";
    for (const Entry& entry : entries) {
        std::string condition;
        for (size_t i = 1; i < entry.words.size(); ++i)
            condition += (i > 1 ? "; and " : "") + ("__fish_seen_subcommand_from " + entry.words[i]);
        std::string names;
        for (const CLI::App* command : entry.commands) names += " " + command->get_name();
        const std::string at = entry.words.size() == 1 ? "__fish_use_subcommand" : condition;
        const std::string unchosen =
            entry.words.size() == 1 ? at : condition + "; and not __fish_seen_subcommand_from" + names;
        for (const CLI::App* command : entry.commands)
            text += "complete -c shvr -n " + single_quoted(unchosen) + " -f -a " + single_quoted(command->get_name()) +
                    " -d " + single_quoted(command->get_description()) + "\n";
        for (const CLI::Option* option : options_of(*entry.app, false)) {
            text += "complete -c shvr -n " + single_quoted(at);
            for (const std::string& name : option->get_snames()) text += " -s " + name;
            for (const std::string& name : option->get_lnames()) text += " -l " + name;
            std::string choices;
            for (const std::string& choice : choices_of(*option)) choices += (choices.empty() ? "" : " ") + choice;
            if (!value_name(*option).empty()) text += choices.empty() ? " -r" : " -x -a " + single_quoted(choices);
            text += " -d " + single_quoted(option->get_description()) + "\n";
        }
    }
    return {"fish/vendor_completions.d/shvr.fish", text};
}

}  // namespace

std::vector<ManualFile> manual_of(const CLI::App& program, const std::string& version)
{
    std::vector<Entry> entries;
    collect(program, {}, entries);
    std::vector<ManualFile> files;
    for (const Entry& entry : entries) files.push_back(page_of(entry, entries, version));
    files.push_back(bash_of(entries));
    files.push_back(zsh_of(entries));
    files.push_back(fish_of(entries));
    return files;
}

}  // namespace shvr::cli
