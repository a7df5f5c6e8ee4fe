#include "engine/remote/s3.h"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

constexpr int64_t MAX_FILE_BYTES = int64_t{1} << 20;

std::string variable(const char* name)
{
    const char* const value = std::getenv(name);
    return value == nullptr ? std::string() : std::string(trimmed(value));
}

using Section = std::map<std::string, std::string>;

/// Returns a section of an INI file in the syntax of the AWS tools. Empty if file or section does not exist.
Section section_of(const fs::path& file, std::string_view name)
{
    std::error_code ignored;
    Section section;
    if (file.empty() || !fs::exists(file, ignored)) return section;
    const std::string text = read_text(file, MAX_FILE_BYTES);
    std::string_view rest = text;
    bool is_in_it = false;
    while (!rest.empty()) {
        const std::string_view line = take_line(rest);
        const std::string_view content = trimmed(line);
        if (content.empty() || content.front() == '#' || content.front() == ';') continue;
        if (content.front() == '[') {
            const size_t end = content.find(']');
            if (end == std::string_view::npos)
                fail(file.string(), ": has a section without its closing bracket; expected [name]");
            is_in_it = trimmed(content.substr(1, end - 1)) == name;
            continue;
        }
        const size_t equals = content.find('=');
        const bool is_nested = line.front() == ' ' || line.front() == '\t';  // as below "s3 ="
        if (!is_in_it || is_nested || equals == std::string_view::npos) continue;
        section[lower_case(trimmed(content.substr(0, equals)))] = trimmed(content.substr(equals + 1));
    }
    return section;
}

fs::path file_of(const char* name_of_variable, const char* name)
{
    if (const std::string path = variable(name_of_variable); !path.empty()) return path;
    const std::string home = variable("HOME");
    return home.empty() ? fs::path() : fs::path(home) / ".aws" / name;
}

/// Merges the profile's settings in both files. Settings of the credentials file take precedence.
Section profile_settings(const std::string& profile)
{
    const fs::path config = file_of("AWS_CONFIG_FILE", "config");
    const fs::path credentials = file_of("AWS_SHARED_CREDENTIALS_FILE", "credentials");
    Section settings = section_of(config, profile == "default" ? profile : "profile " + profile);
    const Section keys = section_of(credentials, profile);
    if (settings.empty() && keys.empty() && !variable("AWS_PROFILE").empty())
        fail("environment variable AWS_PROFILE is ", in_quotes(profile), ", of which neither ", config.string(),
             " nor ", credentials.string(), " has a section; expected a profile in one of them");
    for (const auto& [key, value] : keys) settings[key] = value;
    return settings;
}

std::string first_of(std::initializer_list<std::string> texts)
{
    for (const std::string& text : texts)
        if (!text.empty()) return text;
    return {};
}

std::string setting(const Section& settings, const char* key)
{
    const auto found = settings.find(key);
    return found == settings.end() ? std::string() : found->second;
}

/// Fails if the keys would have to be fetched from a service first.
void refuse_fetched_keys(const std::string& profile, const Section& settings)
{
    constexpr const char* EXPECTED =
        "; expected keys in AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and AWS_SESSION_TOKEN, as `aws configure "
        "export-credentials` writes them";
    for (const auto& [key, value] : settings)
        if (key.starts_with("sso_") || key == "role_arn" || key == "credential_process" || key == "credential_source" ||
            key == "web_identity_token_file")
            fail("the AWS profile ", in_quotes(profile), " has ", key,
                 ", which is not supported (SSO, roles and processes)", EXPECTED);
    for (const char* const name : {"AWS_WEB_IDENTITY_TOKEN_FILE", "AWS_CONTAINER_CREDENTIALS_RELATIVE_URI",
                                   "AWS_CONTAINER_CREDENTIALS_FULL_URI"})
        if (!variable(name).empty())
            fail("environment variable ", name, " is set: keys of instances and containers are not supported",
                 EXPECTED);
}

std::optional<SigningKeys> keys_of(const std::string& profile, const Section& settings)
{
    const std::string anonymous = lower_case(variable("AWS_NO_SIGN_REQUEST"));
    if (anonymous == "yes" || anonymous == "true" || anonymous == "1") return std::nullopt;
    SigningKeys keys{.id = variable("AWS_ACCESS_KEY_ID"),
                     .secret = variable("AWS_SECRET_ACCESS_KEY"),
                     .token = variable("AWS_SESSION_TOKEN")};
    if (keys.id.empty() != keys.secret.empty())
        fail("environment variable ", keys.id.empty() ? "AWS_ACCESS_KEY_ID" : "AWS_SECRET_ACCESS_KEY",
             " is not set, though the other of the pair is; expected both");
    if (keys.id.empty()) {
        keys = {.id = setting(settings, "aws_access_key_id"),
                .secret = setting(settings, "aws_secret_access_key"),
                .token = setting(settings, "aws_session_token")};
        if (keys.id.empty() != keys.secret.empty())
            fail("the AWS profile ", in_quotes(profile),
                 " has only one of aws_access_key_id and aws_secret_access_key; "
                 "expected both");
    }
    if (keys.id.empty()) {
        refuse_fetched_keys(profile, settings);
        return std::nullopt;
    }
    if (has_controls(keys.id + keys.secret + keys.token))
        fail("the AWS keys contain control characters; expected printable ones");
    return keys;
}

}  // namespace

S3Place s3_place(const Address& address)
{
    const std::string profile = first_of({variable("AWS_PROFILE"), "default"});
    const Section settings = profile_settings(profile);
    S3Place place;
    place.region =
        first_of({variable("AWS_REGION"), variable("AWS_DEFAULT_REGION"), setting(settings, "region"), "us-east-1"});
    if (place.region.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") != std::string::npos)
        fail("the AWS region is ", in_quotes(place.region), "; expected a name such as eu-central-1");
    place.keys = keys_of(profile, settings);
    if (place.keys) place.keys->region = place.region;
    const std::string endpoint =
        first_of({variable("AWS_ENDPOINT_URL_S3"), variable("AWS_ENDPOINT_URL"), setting(settings, "endpoint_url")});
    if (!endpoint.empty()) {
        const Address server = parse_address(endpoint);
        if (server.scheme == Scheme::s3)
            fail("the AWS endpoint is ", in_quotes(endpoint), "; expected an http or https address");
        place.url = url_of(server) + "/" + address.host + address.path;
        return place;
    }
    // The servers' TLS certificate is for *.SERVER with one label: a bucket whose name has dots must go into the path.
    const std::string server = "s3." + place.region + ".amazonaws.com";
    const bool has_dots = address.host.find('.') != std::string::npos;
    place.url = has_dots ? "https://" + server + "/" + address.host + address.path
                         : "https://" + address.host + "." + server + address.path;
    return place;
}

}  // namespace shvr
