// The fixed parts of the report page.
#pragma once

namespace palpate {

extern const char* const kReportStyle;     ///< CSS
extern const char* const kReportBody;      ///< HTML from the canvas to the plots
extern const char* const kReportScript;    ///< JavaScript: what is drawn, and ...
extern const char* const kReportControls;  ///< ... what the user does

}  // namespace palpate
