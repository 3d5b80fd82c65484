; BROKEN     Twin of 04a_no_contact_while_reacting.smt2: the guard forgets that the thing moves.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const t Real)        ; time that passes
(declare-const x Real)        ; robot's own way meanwhile
; Formulas
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun time_to_rest ((w Real)) Real (+ eps (/ w b)))
(define-fun need ((w Real)) Real
  (* kappa (+ s (way_to_rest w))))                           ; BROKEN: no V

; Assumptions
(assert (> b 0))
(assert (> eps 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= w 0))
(assert (>= t 0))
(assert (>= x 0))
(assert (<= (need w) d))
(assert (<= t eps))
(assert (<= x (* w t)))

; Conclusion, negated
(assert (not (>= (- d (* kappa (+ s x)) (* V (+ age t))) 0)))
(check-sat)
