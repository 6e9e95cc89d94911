"""The live page: a process of its own that shows what the tracking process tells it.

The tracking process binds and listens, starts the page process and sends it snapshots, events and
health over a link (`trecsim.page.page_process`). The page process serves them to browsers and
programs (`trecsim.page.app`). A slow viewer or a crash of the page costs the tracking nothing.
"""
