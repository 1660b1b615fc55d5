-- Checks `impellerc lsp` in a real Neovim, from 0.7.2 on:
--
--     IMPELLERC=path/to/impellerc nvim --clean --headless -n -i NONE -S editors/neovim/check.lua
--
-- Prints one line for each thing that holds; ends with code 1 at the first one that does not.

local program = os.getenv("IMPELLERC") or "impellerc"
local here = vim.fn.fnamemodify(debug.getinfo(1, "S").source:sub(2), ":p:h")
local jobs = vim.fn.fnamemodify(here .. "/../../jobs/small", ":p")
local folder = vim.fn.tempname()

local function leave(code)
  vim.fn.delete(folder, "rf")
  vim.cmd(code == 0 and "qall!" or "cquit 1")
end

-- What Neovim does when a script fails is to go on, for ever.
local function checks()
  local function holds(what, fact, found)
    if not fact then
      error(what .. (found and (": " .. vim.inspect(found)) or ""), 0)
    end
    io.stdout:write("neovim: " .. what .. "\n")
  end

  vim.fn.mkdir(folder, "p")
  local function copy(from, to, change)
    local lines = vim.fn.readfile(jobs .. from)
    for number, line in ipairs(lines) do
      lines[number] = change(line)
    end
    vim.fn.writefile(lines, folder .. "/" .. to)
  end
  copy("vane_curves.csv", "vane_curves.csv", function(line)
    return line
  end)
  -- One line of the job has it.
  copy("small.imp", "wheel.imp", function(line)
    return (line:gsub("feed 150", "fed 150"))
  end)

  vim.cmd("edit " .. vim.fn.fnameescape(folder .. "/wheel.imp"))
  local buffer = vim.api.nvim_get_current_buf()
  local row = vim.fn.search("\\<fed\\>", "w") - 1
  local column = vim.fn.col(".") - 1

  local ended
  local client_id = vim.lsp.start_client({
    name = "impellerc",
    cmd = { program, "lsp" },
    root_dir = folder,
    on_exit = function(code)
      ended = code
    end,
  })
  holds("the service starts", client_id)
  vim.lsp.buf_attach_client(buffer, client_id)
  local client
  vim.wait(10000, function()
    client = vim.lsp.get_client_by_id(client_id)
    return client and client.initialized
  end, 20)
  holds("the service attaches to a job", client and client.initialized and client.server_capabilities)

  local function faults()
    return vim.diagnostic.get(buffer, { severity = vim.diagnostic.severity.ERROR })
  end
  vim.wait(10000, function()
    return #faults() > 0
  end, 20)
  local fault = faults()[1]
  holds(
    "a misspelt property is a fault at its place",
    #faults() == 1 and fault.lnum == row and fault.col == column and fault.end_col == column + 3,
    faults()
  )

  local function ask(method, at)
    local params = { textDocument = { uri = vim.uri_from_bufnr(buffer) }, position = at }
    if method == "textDocument/formatting" then
      params.options = { tabSize = 2, insertSpaces = true }
    end
    local answer, failure = client.request_sync(method, params, 10000, buffer)
    if not answer or answer.err then
      error(method .. ": " .. (failure or vim.inspect(answer)), 0)
    end
    return answer.result
  end

  local hover = ask("textDocument/hover", { line = row, character = column })
  holds("hover explains the fault", hover and hover.contents.value:find("^%*%*IMP%d%d%d%d: "), hover)

  -- The end of `fe` in a line that is not finished.
  vim.api.nvim_buf_set_text(buffer, row, column, row, column + 3, { "fe" })
  local offered = {}
  for _, item in ipairs(ask("textDocument/completion", { line = row, character = column + 2 })) do
    offered[item.label] = true
  end
  holds("completion offers the property", offered.feed, offered)

  vim.api.nvim_buf_set_text(buffer, row, column, row, column + 2, { "feed" })
  vim.wait(10000, function()
    return #faults() == 0
  end, 20)
  holds("an edit removes the fault", #faults() == 0, faults())

  local right = vim.api.nvim_buf_get_lines(buffer, 0, -1, true)
  vim.api.nvim_buf_set_text(buffer, row, 0, row, 0, { "        " })
  vim.lsp.util.apply_text_edits(ask("textDocument/formatting"), buffer, client.offset_encoding)
  holds(
    "format gives a displaced line its indentation back",
    vim.deep_equal(vim.api.nvim_buf_get_lines(buffer, 0, -1, true), right),
    vim.api.nvim_buf_get_lines(buffer, row, row + 1, true)
  )

  client.stop()
  vim.wait(10000, function()
    return ended ~= nil
  end, 20)
  holds("the service stops in order", ended == 0, ended)
end

local passed, why = pcall(checks)
if not passed then
  io.stderr:write("neovim: does not hold: " .. tostring(why) .. "\n")
end
leave(passed and 0 or 1)
