#include "engine/formats/tiff/tiff_choice.h"

#include <tiffio.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/choice.h"

namespace shvr {
namespace {

constexpr const char* RGB[] = {"red", "green", "blue"};

bool is_plain_word(const std::string& name)
{
    return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    });
}

/// Returns the numbers 1 to `count` as text: "1 or 2", "1, 2 or 3", "1 to 40".
std::string numbers_to(int64_t count)
{
    if (count > 6) return sentence("1 to ", count);
    std::string text = "1";
    for (int64_t i = 2; i <= count; ++i) text += sentence(i == count ? " or " : ", ", i);
    return text;
}

/// Lists the words by which a user can choose a channel: its name if that is a unique word, otherwise its number.
std::string channel_choices(const std::vector<std::string>& names)
{
    constexpr size_t MOST = 8;
    if (names.size() > MOST) return numbers_to(int64_t(names.size()));
    std::string text;
    for (size_t i = 0; i < names.size(); ++i) {
        const bool is_unique = std::count(names.begin(), names.end(), names[i]) == 1;
        if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
        text += is_plain_word(names[i]) && is_unique ? names[i] : std::to_string(i + 1);
    }
    return text;
}

std::string channel_names(const std::vector<std::string>& names)
{
    constexpr size_t MOST = 8;
    std::string text;
    for (size_t i = 0; i < std::min(MOST, names.size()); ++i) {
        if (i > 0) text += ", ";
        text += names[i].empty()          ? std::to_string(i + 1)
                : is_plain_word(names[i]) ? names[i]
                                          : sentence(i + 1, " = ", in_quotes(names[i]));
    }
    return text + (names.size() > MOST ? ", ..." : "");
}

std::string frame_choices(int64_t frames)
{
    return "--frame " + numbers_to(frames);
}

size_t chosen_channel(const std::string& subject, const std::string& wanted, const std::vector<std::string>& names)
{
    const auto refuse = [&](const char* why) {
        fail(subject, ": ", why, in_quotes(wanted), "; expected ", channel_choices(names));
    };
    const auto is_wanted = [&](const std::string& name) {
        return !name.empty() && lower_case(trimmed(name)) == lower_case(trimmed(wanted));
    };
    const auto found = std::find_if(names.begin(), names.end(), is_wanted);
    if (found != names.end()) {
        if (std::any_of(found + 1, names.end(), is_wanted)) refuse("has several channels ");
        return size_t(found - names.begin());
    }
    const std::optional<int64_t> number = whole_of(trimmed(wanted));
    if (!number || *number < 1 || *number > int64_t(names.size())) refuse("has no channel ");
    return size_t(*number - 1);
}

bool is_grey_ramp(const std::vector<uint16_t>& palette)
{
    const auto last = double(palette.size() - 1);
    for (size_t i = 0; i < palette.size(); ++i) {
        const double expected = double(i) / last;
        // The tolerance admits both usual forms of a palette value: 8 bits in the upper byte, and full 16 bits.
        if (std::abs(palette[i] / 65535.0 - expected) > 1.0 / 250.0) return false;
    }
    return true;
}

std::vector<TiffPixelChannel> palette_channels(const TiffPage& page, const TiffLayout& layout,
                                               const TiffDescription& description, std::vector<std::string>& warnings)
{
    const std::vector<uint16_t> red = palette_of(page, layout, 0);
    const bool is_grey = red == palette_of(page, layout, 1) && red == palette_of(page, layout, 2);
    bool is_ramp = true;
    for (int color = 0; color < 3; ++color) is_ramp = is_ramp && is_grey_ramp(palette_of(page, layout, color));
    if (is_ramp) return {{}};
    if (description.writer != TiffDescription::Writer::unknown) {
        // In files by ImageJ or OME, the palette only colours the display; the intensities are the indices into it.
        warnings.emplace_back("the colours of its lookup table were left out");
        return {{}};
    }
    std::vector<TiffPixelChannel> channels{{"index"}, {"red", 0, 0}, {"green", 0, 1}, {"blue", 0, 2}};
    if (is_grey) channels.insert(channels.begin(), TiffPixelChannel{"grey", 0, 0, true});
    return channels;
}

}  // namespace

std::vector<TiffPixelChannel> channels_of_pixel(const TiffPage& page, const TiffLayout& layout,
                                                const TiffDescription& description, std::vector<std::string>& warnings)
{
    if (layout.photometric == PHOTOMETRIC_PALETTE) return palette_channels(page, layout, description, warnings);
    if (layout.samples == 1) return {{}};

    std::vector<std::string> names;
    if (layout.photometric == PHOTOMETRIC_RGB || layout.photometric == PHOTOMETRIC_YCBCR) {
        names = {RGB[0], RGB[1], RGB[2]};
    } else if (layout.photometric == PHOTOMETRIC_SEPARATED) {
        const bool is_cmyk = page.number16(TIFFTAG_INKSET, INKSET_CMYK) == INKSET_CMYK && layout.samples >= 4;
        if (is_cmyk) names = {"cyan", "magenta", "yellow", "black"};
    }
    std::vector<TiffPixelChannel> channels;
    const auto samples = size_t(layout.samples);
    const size_t extra_from = samples - std::min(samples, layout.extra_samples.size());
    for (size_t sample = 0; sample < samples; ++sample) {
        std::string name;
        if (sample < names.size()) {
            name = names[sample];
        } else if (sample >= extra_from) {
            const int meaning = layout.extra_samples[sample - extra_from];
            if (meaning == EXTRASAMPLE_ASSOCALPHA || meaning == EXTRASAMPLE_UNASSALPHA) name = "alpha";
        }
        channels.push_back({name, int(sample)});
    }
    // Some writers do not declare the fourth sample after red, green and blue, which is almost always alpha.
    const bool is_rgb = layout.photometric == PHOTOMETRIC_RGB || layout.photometric == PHOTOMETRIC_YCBCR;
    if (is_rgb && samples == 4) channels[3].name = "alpha";
    const bool has_alpha = samples == 2 && channels[1].name == "alpha";
    if (has_alpha) channels[0].name = "grey";
    return channels;
}

OpenOptions with_usual_channel(const OpenOptions& options, const std::vector<TiffPixelChannel>& channels,
                               std::vector<std::string>& warnings)
{
    OpenOptions wanted = options;
    if (!wanted.channel.empty() || !channels.front().is_usual) return wanted;
    wanted.channel = channels.front().name;
    warnings.emplace_back("its palette is grey: the palette's greys are taken; --channel index takes its numbers");
    return wanted;
}

TiffChoice choose(const std::string& subject, const OpenOptions& options, const std::vector<std::string>& names,
                  int64_t frames, bool may_be_slices)
{
    const bool needs_channel = names.size() > 1 && options.channel.empty();
    const bool needs_frame = frames > 1 && options.frame.empty();
    Choice channels = Choice::numbered("channel", int64_t(names.size()), names);
    Choice times = Choice::numbered("frame", frames);
    std::string or_slices;
    if (may_be_slices) {
        Choice& taken = frames > 1 ? times : channels;
        taken.values.emplace_back(AS_SLICES);
        taken.titles.emplace_back("all of them, as the slices of one volume");
        or_slices = sentence("; --", taken.key, " ", AS_SLICES, " takes all of them as the slices of one volume");
    }
    if (needs_channel && needs_frame) {
        throw ChoiceNeeded(sentence(subject, ": has ", names.size(), " channels (", channel_names(names), ") and ",
                                    frames, " time points; expected one of each: choose with --channel ",
                                    channel_choices(names), " and ", frame_choices(frames), or_slices),
                           {channels, times});
    }
    if (needs_channel) {
        throw ChoiceNeeded(sentence(subject, ": has ", names.size(), " channels (", channel_names(names),
                                    "); expected one: choose with --channel ", channel_choices(names), or_slices),
                           {channels});
    }
    if (needs_frame) {
        throw ChoiceNeeded(sentence(subject, ": has ", frames, " time points; expected one: choose with ",
                                    frame_choices(frames), or_slices),
                           {times});
    }
    TiffChoice choice;
    if (!options.channel.empty()) choice.channel = chosen_channel(subject, options.channel, names);
    if (!options.frame.empty()) {
        const std::optional<int64_t> frame = whole_of(trimmed(options.frame));
        if (!frame || *frame < 1 || *frame > frames) {
            fail(subject, ": has no time point ", in_quotes(options.frame), "; expected ", numbers_to(frames));
        }
        choice.frame = *frame - 1;
    }
    return choice;
}

}  // namespace shvr
