// How a reply has to look.
#pragma once

namespace ex9000::judges {

/// What a reply is to a request.
enum class ReplyForm {
  Wrong,    ///< none that the request can have
  Answer,   ///< what was asked for, or that it is done
  Refusal,  ///< an exception, `?`, or `!` alone: nothing is changed
};

}  // namespace ex9000::judges
