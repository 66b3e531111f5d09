"""`report.html`: one self-contained page of a finding, for a person; `page.write_report` writes it."""
