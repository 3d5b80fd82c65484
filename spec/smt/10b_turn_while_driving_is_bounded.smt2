; THEOREM    10b: the closing cosine of the guard holds until rest, though the robot turns.
; ASSUMED    The cosine was k0 when the thing was seen; the robot has turned by phi0 since then,
;            and turns no faster than omega until it rests, at te + tb; the cosine grows by no
;            more than the turn (11d, 11e).
; CONCLUDED  At every instant until rest the cosine is at most k0 + phi0 + omega (eps + w/b).
; SOURCE     own; spec/shield.md SH.3.
; TWIN       the turn is bounded for the reaction time only.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const te Real)       ; when the command to rest takes effect
(declare-const tb Real)       ; time spent braking
(declare-const omega Real)    ; bound of the turn rate
(declare-const k0 Real)       ; cosine when the thing was seen
(declare-const phi0 Real)     ; angle turned since then
(declare-const phi Real)      ; angle turned from now to t
(declare-const t Real)        ; an instant before rest
(declare-const k Real)        ; cosine at t
; Formulas
(define-fun time_to_rest ((w Real)) Real (+ eps (/ w b)))

; Assumptions
(assert (> b 0))
(assert (> eps 0))
(assert (>= w 0))
(assert (>= te 0))
(assert (>= tb 0))
(assert (>= omega 0))
(assert (>= phi0 0))
(assert (>= phi 0))
(assert (>= t 0))
(assert (<= te eps))
(assert (<= (* b tb) w))
(assert (<= t (+ te tb)))
(assert (<= phi (* omega t)))
(assert (<= k (+ k0 phi0 phi)))

; Conclusion, negated
(assert (not (<= k (+ k0 phi0 (* omega (time_to_rest w))))))
(check-sat)
