#include "engine/remote/redirects.h"

#include <curl/curl.h>

#include <memory>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/remote/local_host.h"

namespace shvr {

namespace {

using Url = std::unique_ptr<CURLU, void (*)(CURLU*)>;

std::string part_of(const Url& url, CURLUPart part)
{
    char* text = nullptr;
    if (curl_url_get(url.get(), part, &text, 0) != CURLUE_OK) return {};
    std::string copy(text);
    curl_free(text);
    return copy;
}

}  // namespace

Redirect redirect_of(const std::string& name, const std::string& from, const std::string& location, bool is_from_local)
{
    const Url url(curl_url(), curl_url_cleanup);
    if (!url) throw std::bad_alloc();
    if (location.empty() || has_controls(location) ||
        curl_url_set(url.get(), CURLUPART_URL, from.c_str(), 0) != CURLUE_OK)
        fail(name, ": is redirected nowhere; expected a redirect with an address");
    const std::string scheme_before = part_of(url, CURLUPART_SCHEME);
    if (curl_url_set(url.get(), CURLUPART_URL, location.c_str(), CURLU_NON_SUPPORT_SCHEME) != CURLUE_OK)
        fail(name, ": is redirected to something that is no address; expected an http or https address");
    const std::string scheme = lower_case(part_of(url, CURLUPART_SCHEME));
    const std::string host = printable(part_of(url, CURLUPART_HOST));
    if (scheme != "http" && scheme != "https")
        fail(name, ": is redirected to an address with the scheme ", in_quotes(scheme), "; expected http or https");
    if (scheme_before == "https" && scheme == "http")
        fail(name, ": is redirected from https to http, at ", host, "; expected encryption to be kept");
    if (!part_of(url, CURLUPART_USER).empty() || !part_of(url, CURLUPART_PASSWORD).empty())
        fail(name, ": is redirected to ", host, " with a name or a password; expected an address without them");
    if (!is_from_local && is_local_host(host))
        fail(name, ": is redirected from a public host to ", host,
             ", an address of this machine or its link; expected a public one");
    return {.url = part_of(url, CURLUPART_URL), .refuses_local = !is_from_local};
}

}  // namespace shvr
